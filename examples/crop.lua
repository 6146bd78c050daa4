-- crop.lua: short all round, longer on top, brushed forward and a little to the side.
local looks = require "coif/looks"

local p = coif.params {
  top     = { 5.5, min = 2, max = 10, unit = "cm", doc = "length on top" },
  sides   = { 1.6, min = 0.4, max = 4, unit = "cm", doc = "length at sides and back" },
  strands = { 50000, min = 1000, max = 200000, doc = "how many strands" },
}

local head  = coif.head()
local whorl = head:at("vertex", { 1.2, -1, -5 })
local edge  = head:at("vertex", { 0, -5.2, 0 }).y
local scalp = head:scalp()
local upper = scalp:where(function(at) return at.y > edge end)
local everywhere = head:box("all")

local function cut(region, length, count, strands, fields)
  return region
    :guides { count = count, length = length, length_variation = 0.2, step = 0.2, stiffness = 3, lay_from = whorl,
      lay_amount = fields.flat, noise = 0.12 }
    :grow {
      global = coif.queue { coif.domain.directional { box = everywhere, direction = fields.direction, noise = 0.25,
        strength = fields.strength } },
      margin = 0.08,
    }
    :fill { strands = strands, nodes = 16, clump = fields.clump, noise = 0.05, length_variation = 0.25, thickness = 0.25,
      material = looks.brown }
end

local top   = cut(upper, p.top, 500, p.strands * 0.5 // 1, { flat = 0.55, direction = { -0.35, -0.15, 1 }, strength = 0.5, clump = 0.6 })
local sides = cut(scalp - upper, p.sides, 500, p.strands * 0.5 // 1, { flat = 0.7, direction = { 0, -1, -0.2 }, strength = 0.6, clump = 0.2 })

return coif.scene { head, top, sides, views = { "front", "three-quarter", "left", "back" } }
