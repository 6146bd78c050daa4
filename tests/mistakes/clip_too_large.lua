local head = coif.head()
local guides = head:scalp():guides { count = 10, length = 20 }
local hair = coif.clip { guides:grow {}, guides:grow {}, seconds = 60 }
return coif.scene { head, hair:fill { strands = 200000, nodes = 64 } }
