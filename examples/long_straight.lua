-- long_straight.lua: long, straight, parted in the middle.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 58, min = 20, max = 120, unit = "cm", doc = "longest strand" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head    = coif.head()
local parting = head:parting { head:at("forehead"), head:at("vertex"), head:at("occiput", { 0, 4, 0 }) }
local crown   = head:at("vertex", { 0, -5, 0 }).y

-- off the parting: one local queue for each side, on the top of the head
local function side(sign)
  return coif.queue {
    coif.domain.directional {
      box = { min = { -40, crown, -40 }, max = { 40, 40, 40 } }, direction = { 0.55 * sign, -1, -0.45 },
    },
  }
end

-- below the crown everything falls
local fall = coif.queue {
  coif.domain.directional { box = { min = { -60, -120, -60 }, max = { 60, crown, 60 } }, direction = { 0, -1, -0.02 } },
}

local hair = head:scalp():parting(parting)
  :guides { count = 800, length = p.length, length_variation = 0.12, stiffness = 1.2, lay_from = head:at("forehead", { 0, 0, 3 }), lay_amount = 0.75 }
  :grow {
    global = fall,
    locals = {
      { where = function(root) return parting:side(root) >= 0 end, queue = side(1) },
      { where = function(root) return parting:side(root) < 0 end,  queue = side(-1) },
    },
  }
  :fill { strands = p.strands, noise = 0.015, flyaway = 0.01, thickness = 0.7, material = looks.brown }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
