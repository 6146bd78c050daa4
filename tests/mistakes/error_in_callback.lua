local head = coif.head()
local limits = {}
local function is_left(root)
  return root.x > limits.left.x
end
local down = coif.queue { coif.domain.directional { box = head:box("all"), direction = coif.down } }
local hair = head:scalp():guides { count = 5, length = 3 }:grow {
  locals = { { where = is_left, queue = down } },
}
