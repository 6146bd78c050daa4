local head = coif.head()

local hair = head:scalp()
  :guides { count = 800, length = 12 }
  :grow {}

return coif.scene { head, hair, views = { "front", "left", "back" } }
