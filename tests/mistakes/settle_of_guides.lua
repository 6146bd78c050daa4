local head = coif.head()
return head:scalp():guides { count = 20, length = 10 }:settle {}
