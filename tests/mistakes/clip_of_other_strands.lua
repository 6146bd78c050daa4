local head = coif.head()
local short = head:scalp():guides { count = 10, length = 5 }:grow {}
local long = head:scalp():guides { count = 10, length = 15 }:grow {}
return coif.scene { head, coif.clip { short, long } }
