local head = coif.head()
local guides = head:scalp():guides { count = 10, length = 2, step = 5 }
