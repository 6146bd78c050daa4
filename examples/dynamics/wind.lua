-- wind.lua: 2,500 strands of 10 segments under gravity and wind: figure 1 (a) of the method's paper.

local p = coif.params {
  wind    = { 450, min = 0, max = 3000, unit = "cm/s^2", doc = "strength of the wind" },
  strands = { 2500, min = 100, max = 100000, doc = "how many strands" },
}

local head = coif.head()

local hair = head:scalp()
  :guides { count = p.strands, length = 30, length_variation = 0.15, step = 3, stiffness = 1,
    lay_from = head:at("forehead", { 0, 0, 3 }), lay_amount = 0.75 }
  :grow {}
  :settle {
    hold = 5,
    forces = {
      coif.force.gravity {},
      coif.force.wind { direction = { 0.9, 0.1, -0.45 }, strength = p.wind },
    },
  }
  :material { root_colour = "#3b2417", tip_colour = "#6b4426", width = 0.05 }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
