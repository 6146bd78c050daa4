local head = coif.head()

return coif.scene { head, views = { "front", "left", "back" } }
