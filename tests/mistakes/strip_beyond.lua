local head = coif.head()
local turn = head:motion { { time = 0 }, { time = 1, yaw = 60 } }
return coif.scene { head, motion = turn, strip = { 5, 40 } }
