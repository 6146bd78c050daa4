local head = coif.head()
local tie  = head:at("occiput", { 0, 5.5, -2.2 })

local hair = head:scalp()
  :guides { count = 800, length = 50 }
  :grow {
    global = coif.queue {
      coif.domain.gather { priority = 2, core = tie, core_radius = 1 },
      coif.domain.directional { priority = 1, box = head:box("behind"), direction = { 0, -1, 0 } },
    },
  }

return coif.scene { head, hair, views = { "front", "left", "back" } }
