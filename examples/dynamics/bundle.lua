-- bundle.lua: an attractor behind the neck ties falling hair into a bundle: figure 1 (b, c) of the method's paper.
local looks = require "coif/looks"

local p = coif.params {
  guides  = { 600, min = 50, max = 2000, doc = "how many strands are moved" },
  strands = { 20000, min = 500, max = 200000, doc = "how many strands" },
}

local head = coif.head()
local tie  = head:at("nape", { 0, -2, -4 })

local hair = head:scalp()
  :guides { count = p.guides, length = 42, length_variation = 0.15, step = 1.5, stiffness = 1.5,
    lay_from = head:at("forehead", { 0, -1, 3 }), lay_amount = 0.85 }
  :grow {}
  :settle {
    hold = 4, drag = 14, rest_speed = 2,
    forces = {
      coif.force.gravity {},
      coif.force.attractor {
        name = "tie", centre = tie, radius = 1.2, strength = 2500,
        zone = coif.ball { centre = tie, radius = 16 }, edge = 6,
      },
    },
  }
  :fill { strands = p.strands, clump = 0.2, clump_start = 0.3, thickness = 0.6, material = looks.chestnut }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
