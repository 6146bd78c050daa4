local head = coif.head()
local hair = head:scalp():guides(800)
