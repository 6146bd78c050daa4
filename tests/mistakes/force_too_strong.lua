local head = coif.head()
local guides = head:scalp():guides { count = 20, length = 10 }:grow {}
return guides:settle { forces = { coif.force.attractor { name = "tie", centre = { 0, 0, -12 }, strength = 1000000 } } }
