local head = coif.head()

local hair = head:scalp()
  :guides { count = 800, length = 30 }
  :grow {
    global = coif.queue {
      coif.domain.directional { box = head:box("all"), direction = { 0, -1, 0 } },
    },
  }

return coif.scene { head, hair, views = { "front", "left", "back" } }
