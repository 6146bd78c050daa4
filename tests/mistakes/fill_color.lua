local head = coif.head()
local hair = head:scalp():guides { count = 20, length = 3 }:grow {}:fill { strands = 50, color = "brown" }
return coif.scene { head, hair }
