-- waves.lua: shoulder-long waves from a side parting.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 42, min = 20, max = 80, unit = "cm", doc = "longest strand" },
  period  = { 6.5, min = 2, max = 20, unit = "cm", doc = "length of a wave" },
  depth   = { 0.9, min = 0, max = 3, unit = "cm", doc = "height of a wave" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head    = coif.head()
local parting = head:parting { head:at("forehead", { 3, 0, 0 }), head:at("vertex", { 2.5, 0, 0 }), head:at("vertex", { 0.5, -1, -4 }) }
local crown   = head:at("vertex", { 0, -5, 0 }).y

-- off the parting: one local queue for each side, on the top of the head
local function side(sign)
  return coif.queue {
    coif.domain.directional {
      box = { min = { -40, crown, -40 }, max = { 40, 40, 40 } }, direction = { 0.7 * sign, -1, -0.5 },
    },
  }
end

-- below the crown everything falls
local fall = coif.queue {
  coif.domain.directional { box = { min = { -60, -120, -60 }, max = { 60, crown, 60 } }, direction = { 0, -1, -0.05 } },
}

local hair = head:scalp():parting(parting)
  :guides { count = 500, length = p.length, length_variation = 0.2, stiffness = 1.5, lay_from = head:at("forehead", { 3, 0, 3 }), lay_amount = 0.6 }
  :grow {
    global = fall,
    locals = {
      { where = function(root) return parting:side(root) >= 0 end, queue = side(1) },
      { where = function(root) return parting:side(root) < 0 end,  queue = side(-1) },
    },
  }
  :natural {
    coif.domain.wave {
      box = { min = { -60, -100, -60 }, max = { 60, crown, 60 } },
      period = p.period, radius = p.depth, smooth = 0.2, smooth_end = 0, phase_variation = 0.12, tilt = 20,
    },
  }
  :fill { strands = p.strands, clump = 0.45, clump_start = 0.25, noise = 0.02, flyaway = 0.01, thickness = 0.9, material = looks.blonde }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
