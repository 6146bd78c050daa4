local head = coif.head()
local grown = head:scalp():guides { count = 10, length = 2, step = 1 }:grow {}
return coif.scene { head, grown:fill { strands = 100000, nodes = 4096 } }
