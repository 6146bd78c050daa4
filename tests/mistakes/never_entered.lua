local head = coif.head()
local far = coif.domain.directional { box = coif.box { centre = { 200, 0, 0 }, size = { 5, 5, 5 } }, direction = coif.up, name = "far" }
local down = coif.domain.directional { box = head:box("all"), direction = coif.down }
local queue = coif.queue { down, far }
local hair = head:scalp():guides { count = 20, length = 3 }:grow {
  global = queue,
  locals = { { where = function(root) return root.y > 99 end, queue = queue } },
}
return coif.scene { head, hair }
