-- lifted.lua: long straight hair, lifted at the crown, flared at the ends and bent forward by three words.
local looks = require "coif/looks"

local p = coif.params {
  lift    = { 2.5, min = 0, max = 6, unit = "cm", doc = "how far the crown is lifted" },
  flare   = { 1.5, min = 0.5, max = 2.5, doc = "width at the tips, as a multiple" },
  bend    = { 22, min = -60, max = 60, unit = "degrees", doc = "how far the ends are bent forward" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head    = coif.head()
local parting = head:parting { head:at("forehead"), head:at("vertex"), head:at("occiput", { 0, 4, 0 }) }
local crown   = head:at("vertex", { 0, -5, 0 }).y

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

local straight = head:scalp():parting(parting)
  :guides { count = 800, length = 40, length_variation = 0.06, stiffness = 1.2, lay_from = head:at("forehead", { 0, 0, 3 }), lay_amount = 0.75 }
  :grow {
    global = fall,
    locals = {
      { where = function(root) return parting:side(root) >= 0 end, queue = side(1) },
      { where = function(root) return parting:side(root) < 0 end,  queue = side(-1) },
    },
  }

local hair = straight
  :lift { by = p.lift, from = 0.7, roots = 4 }
  :taper { width = p.flare, from = 0.4, roots = 4 }
  :bend { angle = p.bend, towards = { 0, 0, 1 }, from = 0.5, roots = 4 }
  :fill { strands = p.strands, noise = 0.015, flyaway = 0.01, thickness = 0.7, material = looks.auburn }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
