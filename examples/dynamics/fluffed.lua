-- fluffed.lua: a flat style, and a repeller inside the skull that makes it fluffy.
local looks = require "coif/looks"

local p = coif.params {
  fluff   = { 900, min = 0, max = 5000, unit = "cm/s^2", doc = "strength of the repeller; 0 leaves the hair flat" },
  guides  = { 700, min = 50, max = 2000, doc = "how many strands are moved" },
  strands = { 20000, min = 500, max = 200000, doc = "how many strands" },
}

local head = coif.head()

local hair = head:scalp()
  :guides { count = p.guides, length = 20, length_variation = 0.2, step = 1, stiffness = 1.5,
    lay_from = head:at("vertex", { 0, 1, 2 }), lay_amount = 0.85 }
  :grow {}
  :settle {
    hold = 8, limit = 5,
    forces = {
      coif.force.gravity {},
      coif.force.repeller { centre = head:at("occiput", { 0, 3, 8 }), core = 4, strength = p.fluff },
    },
  }
  :natural { coif.domain.wave { box = head:box("all"), period = 4, radius = 0.35, smooth = 0.2 } }
  :fill { strands = p.strands, noise = 0.05, flyaway = 0.03, thickness = 0.9, material = looks.brown }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
