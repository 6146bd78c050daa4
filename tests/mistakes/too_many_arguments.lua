local head = coif.head()
local p = head:at("vertex", 0, 3, 0)
