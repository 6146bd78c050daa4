local head = 1
local hair = head +
return hair
