local head = coif.head()
local turn = head:motion { { time = 0 }, { time = 1, yaw = 60 }, loop = true }
return coif.scene { head, motion = turn }
