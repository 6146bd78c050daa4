-- three_heads.lua: one style on three heads. It is grown once, on the adult mannequin, and carried: to a head that a
-- lattice has made long and narrow, and to the cartoon mannequin. `--set which=2` shows the second.
local looks = require "coif/looks"

local p = coif.params {
  which   = { 3, min = 1, max = 3, doc = "1 the mannequin, 2 the narrow head, 3 the cartoon head" },
  strands = { 30000, min = 1000, max = 200000, doc = "how many strands" },
}

local adult = coif.head()

-- a long, narrow skull: the lattice goes around the whole head; its upper layers are drawn in, up and back
local net    = coif.lattice { around = adult, margin = 2, divisions = { 2, 4, 2 } }
local narrow = adult:deform {
  net:move { j = { 2, 4 }, scale = { 0.82, 1, 1 }, about = { 0, 0, 0 } }:move { j = { 3, 4 }, by = { 0, 3.5, -1.5 } },
}
local cartoon = coif.head { style = "cartoon" }

local parting = adult:parting { adult:at("forehead"), adult:at("vertex"), adult:at("occiput", { 0, 4, 0 }) }
local crown   = adult:at("vertex", { 0, -5, 0 }).y
local function side(sign)
  return coif.queue {
    coif.domain.directional {
      box = { min = { -40, crown, -40 }, max = { 40, 40, 40 } }, direction = { 0.55 * sign, -1, -0.45 },
    },
  }
end
local fall = coif.queue {
  coif.domain.directional { box = { min = { -60, -120, -60 }, max = { 60, crown, 60 } }, direction = { 0, -1, -0.02 } },
}

local hair = adult:scalp():parting(parting)
  :guides { count = 700, length = 30, length_variation = 0.1, stiffness = 1.2, lay_from = adult:at("forehead", { 0, 0, 3 }), lay_amount = 0.75 }
  :grow {
    global = fall,
    locals = {
      { where = function(root) return parting:side(root) >= 0 end, queue = side(1) },
      { where = function(root) return parting:side(root) < 0 end,  queue = side(-1) },
    },
  }
  :fill { strands = p.strands, noise = 0.015, thickness = 0.7, material = looks.chestnut }

local head = ({ adult, narrow, cartoon })[p.which]
return coif.scene { head, hair:carry { to = head }, views = { "front", "three-quarter", "left" } }
