local head = coif.head()
local guides = head:sclap():guides { count = 10 }
