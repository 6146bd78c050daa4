local head = coif.head()
local hair = head:scalp():guides { count = 20, length = 3 }:grow {}
return coif.scene { head, coif.fill { hair, around = 50 } }
