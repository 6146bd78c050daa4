local head = coif.head()
head:scalp():guides { count = 20, length = 3 }:grow {}
return coif.scene { head, hair }
