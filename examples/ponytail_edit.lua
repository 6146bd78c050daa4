-- ponytail_edit.lua: the quick edit of ponytail.lua (figure 5 c, d of the method's paper). The two last gather domains
-- of A move apart to their symmetric places, U gets a second directional domain and both follow the ties; the natural
-- domain is kept. One ponytail becomes two bunches.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 50, min = 25, max = 90, unit = "cm", doc = "longest strand" },
  tie     = { 1.0, min = 0.5, max = 3, unit = "cm", doc = "radius of the ties" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head    = coif.head()
local parting = head:parting { head:at("forehead"), head:at("vertex"), head:at("occiput"), head:at("nape") }

local function tie(sign) return head:at("vertex", { 8.2 * sign, -4, -3.5 }) end

local function side(sign)
  return coif.queue {
    coif.domain.gather { priority = 2, core = head:at("vertex", { 4.5 * sign, -4, -3 }), core_radius = 4.2 },
    coif.domain.gather {
      priority = 1, core = tie(sign), core_radius = p.tie, scatter = -0.2, direction = { sign, 0.35, -0.15 },
    },
  }
end

local function beside(sign)
  return coif.box { min = { sign * (tie(1).x + 1.8), -100, -40 }, max = { sign * 60, 40, 40 } }
end

local curl = { period = 11, radius = 0.5, radius_tip = 1.6, turn = "mirrored" }
local function curls(sign)
  return coif.domain.curl { box = beside(sign), period = curl.period, radius = curl.radius,
    radius_tip = curl.radius_tip, turn = curl.turn }
end

local hair = head:scalp():parting(parting)
  :guides { count = 800, length = p.length, length_variation = 0.25, stiffness = 1.5,
    lay_from = head:at("chin", { 0, 2, 6 }), lay_amount = 0.85 }
  :grow {
    global = coif.queue {
      coif.domain.directional { box = beside(1),  direction = { 0.08, -1, 0 }, strength = 0.6 },
      coif.domain.directional { box = beside(-1), direction = { -0.08, -1, 0 }, strength = 0.6 },
    },
    locals = {
      { where = function(root) return parting:side(root) >= 0 end, queue = side(1) },
      { where = function(root) return parting:side(root) < 0 end,  queue = side(-1) },
    },
  }
  :natural { curls(1), curls(-1) }
  :fill { strands = p.strands, clump = 0.35, clump_start = 0.4, thickness = 0.6, material = looks.chestnut }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
