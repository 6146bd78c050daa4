-- three_heads.lua: one style on three heads. It is grown once, on the adult mannequin, and carried: to a head that a
-- lattice has made long and narrow, and to the cartoon mannequin.
local looks = require "coif/looks"

local p = coif.params {
  strands = { 16000, min = 1000, max = 100000, doc = "how many strands on each head" },
  which   = { 0, min = 0, max = 3, doc = "0 for all heads, or one of them" },
}

local adult = coif.head()

-- a long, narrow skull: the lattice goes around the whole head, its upper layers are moved
local net    = coif.lattice { around = adult, margin = 2, divisions = { 2, 4, 2 } }
local narrow = adult:deform {
  net:move { j = { 2, 4 }, scale = { 0.8, 1, 1.02 }, about = { 0, 0, 0 } }:move { j = { 3, 4 }, by = { 0, 4, -1.2 } },
}
local cartoon = coif.head { style = "cartoon" }

local jaw  = adult:at("chin", { 0, 1.5, 0 }).y
local ears = adult:at("left_ear", { 0, 1, 0 }).y
local function band(low, high) return { min = { -60, low, -60 }, max = { 60, high, 60 } } end
local function side(sign)
  return coif.queue {
    coif.domain.directional { priority = 2, box = band(ears, 60), direction = { 0.85 * sign, -1, -0.4 } },
    coif.domain.directional { priority = 1, box = band(jaw, ears + 1), direction = { 0.04 * sign, -1, 0.02 } },
  }
end

local hair = adult:scalp()
  :guides { count = 600, length = 34, stiffness = 1.6, lay_from = adult:at("forehead", { 0, 0, 3 }), lay_amount = 0.7 }
  :grow {
    locals = {
      { where = function(root) return root.x >= 0 end, queue = side(1) },
      { where = function(root) return root.x < 0 end,  queue = side(-1) },
    },
  }
  :fill { strands = p.strands, noise = 0.012, length_variation = 0.04, thickness = 0.8, material = looks.chestnut }

local heads = { adult, narrow, cartoon }
local shown = heads[math.max(p.which, 1)]
return coif.scene { shown, hair:carry { to = shown }, views = { "front", "three-quarter", "left" } }
