-- NAME.lua: combed to the back and held in a low tail. Change a number, save, and look at the picture again:
--   coif watch NAME.lua                      draws it at every save
--   coif run NAME.lua                        writes out/NAME.png and out/NAME.glb
--   coif run NAME.lua --set length=60        with another value of a parameter
local looks = require "coif/looks"

-- What may be turned without reading on; `coif params NAME.lua` lists it.
local p = coif.params {
  length  = { 45, min = 20, max = 90, unit = "cm", doc = "longest strand" },
  tie     = { 1.0, min = 0.5, max = 3, unit = "cm", doc = "radius of the tie" },
  strands = { 30000, min = 200, max = 200000, integer = true, doc = "how many strands" },
}

-- The head stands at the origin: x points to its left, y up, z to the front, in centimetres.
local head = coif.head()
local tie  = head:at("nape", { 0, 4, -2.5 })  -- a landmark plus an offset

-- Hair grows step by step through a queue of domains. Those of the highest priority act first; the next act on a strand
-- when the ones before have let it go.
local function side(sign)
  return coif.queue {
    -- past the ear ...
    coif.domain.gather { priority = 2, core = head:at("occiput", { 4.5 * sign, 0, 3 }), core_radius = 4 },
    -- ... to the tie ...
    coif.domain.gather { priority = 1, core = tie, core_radius = p.tie, scatter = -0.2, direction = { 0, -0.6, -1 } },
  }
end

-- ... and down behind it.
local behind = coif.box { min = { -25, -100, -60 }, max = { 25, 30, tie.z - 0.5 } }
local fall   = coif.queue { coif.domain.directional { box = behind, direction = { 0, -1, -0.05 } } }

local hair = head:scalp()
  -- a few hundred guides, each standing for one wisp; they lie away from the chin from the first
  :guides { count = 600, length = p.length, length_variation = 0.2, stiffness = 1.5,
    lay_from = head:at("chin", { 0, 2, 6 }), lay_amount = 0.85 }
  :grow {
    global = fall,
    locals = {
      { where = function(root) return root.x >= 0 end, queue = side(1) },
      { where = function(root) return root.x < 0 end,  queue = side(-1) },
    },
  }
  -- a soft wave in the tail
  :natural { coif.domain.wave { box = behind, period = 12, radius = 0.6, phase_variation = 0.3, smooth_end = 0 } }
  -- and all the strands between the guides
  :fill { strands = p.strands, clump = 0.3, clump_start = 0.4, thickness = 0.6, material = looks.chestnut }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
