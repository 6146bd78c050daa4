-- top_knot.lua: everything swept up to the crown and wound into a bun by gather domains that stand in a ring.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 58, min = 40, max = 90, unit = "cm", doc = "longest strand" },
  bun     = { 3, min = 1.5, max = 5, unit = "cm", doc = "radius of the bun" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head = coif.head()
local tie  = head:at("vertex", { 0, 1.2, -3.5 })
local out  = head:normal(tie)

-- a ring about the tie, with as many gather domains as it takes to wind the hair
local across = vector.cross(out, vector.create(1, 0, 0))
local stages = {
  coif.domain.gather { priority = 100, core = tie, core_radius = 1.0, scatter = 0.2, direction = out },
}
local function wind(sign, start)
  local queue = { table.unpack(stages) }
  for i = 0, 13 do
    local a = start + sign * i * math.pi / 2.5
    local r = p.bun * (0.75 + 0.25 * math.sin(i))
    local core = tie + out * (1.6 + 0.5 * math.sin(1.7 * i)) + vector.create(1, 0, 0) * (r * math.cos(a)) + across * (r * math.sin(a))
    table.insert(queue, coif.domain.gather { priority = 90 - i, core = core, core_radius = 0.9 })
  end
  return coif.queue(queue)
end

local hair = head:scalp()
  :guides { count = 700, length = p.length, length_variation = 0.1, stiffness = 2,
    lay_from = head:at("chin", { 0, 2, 0 }), lay_amount = 0.85 }
  :grow {
    locals = {
      { where = function(root) return root.x >= 0 end, queue = wind(1, 0) },
      { where = function(root) return root.x < 0 end,  queue = wind(1, math.pi) },
    },
  }
  :fill { strands = p.strands, clump = 0.3, clump_start = 0.5, thickness = 0.5, material = looks.black }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
