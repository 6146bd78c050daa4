-- ringlets.lua: tight corkscrews, each guide one ringlet.
local looks = require "coif/looks"

local p = coif.params {
  length   = { 36, min = 15, max = 70, unit = "cm", doc = "longest strand, uncurled" },
  ringlets = { 190, min = 30, max = 600, doc = "how many ringlets" },
  strands  = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head    = coif.head()
local parting = head:parting { head:at("forehead"), head:at("vertex"), head:at("occiput", { 0, 4, 0 }) }
local crown   = head:at("vertex", { 0, -4, 0 }).y

-- off the parting: one local queue for each side, on the top of the head
local function side(sign)
  return coif.queue {
    coif.domain.directional {
      box = { min = { -40, crown, -40 }, max = { 40, 40, 40 } }, direction = { 0.7 * sign, -1, -0.45 },
    },
  }
end

-- below the crown everything falls
local fall = coif.queue {
  coif.domain.directional { box = { min = { -60, -120, -60 }, max = { 60, crown, 60 } }, direction = { 0, -1, -0.02 } },
}

local hair = head:scalp():parting(parting)
  :guides { count = p.ringlets, length = p.length, length_variation = 0.25, stiffness = 2, lay_from = head:at("forehead", { 0, 0, 3 }), lay_amount = 0.5 }
  :grow {
    global = fall,
    locals = {
      { where = function(root) return parting:side(root) >= 0 end, queue = side(1) },
      { where = function(root) return parting:side(root) < 0 end,  queue = side(-1) },
    },
  }
  :natural {
    coif.domain.curl {
      box = { min = { -60, -100, -60 }, max = { 60, crown + 2, 60 } },
      period = 3.4, radius = 0.95, radius_tip = 0.7, smooth = 0.15, smooth_end = 0, phase_variation = 1,
      radius_variation = 0.3, turn = "random",
    },
  }
  :fill { strands = p.strands, neighbours = 1, clump = 0.88, clump_start = 0.05, noise = 0.02, thickness = 0.5, material = looks.auburn }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
