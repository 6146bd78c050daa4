local head = coif.head()
local scalp = head.scalp()
