local head = coif.head()
local down = coif.queue { coif.domain.directional { box = head:box("all"), direction = coif.down } }
local hair = head:scalp():guides { count = 5, length = 3 }:grow {
  locals = { { where = function(root) root.x = 0 end, queue = down } },
}
