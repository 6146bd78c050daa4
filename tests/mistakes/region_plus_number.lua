local head = coif.head()
local more = head:scalp() + 3
