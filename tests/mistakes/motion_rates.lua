local head = coif.head()
local guides = head:scalp():guides { count = 10, length = 5 }
local hair = coif.clip { guides:grow {}, guides:grow {}, rate = 30 }
local turn = head:motion { { time = 0 }, { time = 1, yaw = 60 } }
return coif.scene { head, hair, motion = turn }
