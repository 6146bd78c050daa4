-- ponytail.lua: gathered to a tie at the back of the head, then falling in loose curls.
-- The hairstyle of figure 5 (a, b) of the method's paper; ponytail_edit.lua is its quick edit.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 50, min = 25, max = 90, unit = "cm", doc = "longest strand" },
  tie     = { 1.0, min = 0.5, max = 3, unit = "cm", doc = "radius of the tie" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head = coif.head()
local tie  = head:at("occiput", { 0, 5.5, -2.2 })  -- a landmark plus an offset, in head space

-- A: a pair of gather domains for each side. The first draws the hair back, the second into the tie.
local function side(sign)
  return coif.queue {
    coif.domain.gather { priority = 2, core = head:at("occiput", { 3 * sign, 5, 2 }), core_radius = 4 },
    coif.domain.gather {
      priority = 1, core = tie, core_radius = p.tie, scatter = -0.2, direction = { 0, 0.25, -1 },
    },
  }
end

-- U: behind the tie everything falls.
local behind = coif.box { min = { -25, -100, -60 }, max = { 25, 30, tie.z - 0.5 } }

local hair = head:scalp()
  :guides { count = 800, length = p.length, length_variation = 0.25, stiffness = 1.5,
    lay_from = head:at("chin", { 0, 2, 6 }), lay_amount = 0.85 }
  :grow {
    global = coif.queue { coif.domain.directional { box = behind, direction = { 0, -1, -0.06 }, strength = 0.6 } },
    locals = {
      { where = function(root) return root.x >= 0 end, queue = side(1) },
      { where = function(root) return root.x < 0 end,  queue = side(-1) },
    },
  }
  :natural { coif.domain.curl { box = behind, period = 11, radius = 0.5, radius_tip = 1.6, turn = "mirrored" } }
  :fill { strands = p.strands, clump = 0.35, clump_start = 0.4, thickness = 0.6, material = looks.chestnut }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
