local head = coif.head()
local guides = head:scalp():guides { count = 1e9 }
