local head = coif.head()
local guides = head:scalp():guides { count = 0, length = -3 }
