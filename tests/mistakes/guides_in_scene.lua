local head = coif.head()
local guides = head:scalp():guides { count = 10 }
return coif.scene { head, guides }
