local head = coif.head()
local guides = head:scalp():guides { count = 20, length = 10 }:grow {}
local turn = head:motion { { time = 0 }, { time = 1, yaw = 60 }, rate = 12 }
return guides:simulate { motion = turn, rate = 24 }
