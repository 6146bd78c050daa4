local head = coif.head()
local tie  = head:at("occiput", { 0, 5.5, -2.2 })

local function side(sign)
  return coif.queue {
    coif.domain.gather { priority = 2, core = head:at("occiput", { 3 * sign, 5, 2 }), core_radius = 4 },
    coif.domain.gather { priority = 1, core = tie, core_radius = 1 },
  }
end

local behind = coif.box { min = { -25, -100, -60 }, max = { 25, 30, tie.z - 0.5 } }

local hair = head:scalp()
  :guides { count = 800, length = 50, length_variation = 0.25, stiffness = 1.5,
    lay_from = head:at("chin", { 0, 2, 6 }), lay_amount = 0.85 }
  :grow {
    global = coif.queue { coif.domain.directional { box = behind, direction = { 0, -1, 0 } } },
    locals = {
      { where = function(root) return root.x >= 0 end, queue = side(1) },
      { where = function(root) return root.x < 0 end,  queue = side(-1) },
    },
  }

return coif.scene { head, hair, views = { "front", "left", "back" } }
