-- lifted.lua: a long straight hairstyle, lifted over the crown and flared at the ends by three words.
local looks = require "coif/looks"

local p = coif.params {
  lift    = { 2.6, min = 0, max = 6, unit = "cm", doc = "how far the crown is lifted" },
  flare   = { 1.55, min = 0.5, max = 2.5, doc = "width at the tips, as a multiple" },
  strands = { 30000, min = 1000, max = 200000, doc = "how many strands" },
}

local head = coif.head()
local jaw  = head:at("chin", { 0, 0, 0 }).y
local ears = head:at("left_ear").y

local function band(low, high) return { min = { -60, low, -60 }, max = { 60, high, 60 } } end
local function side(sign)
  return coif.queue {
    coif.domain.directional { priority = 2, box = band(ears, 60), direction = { 0.9 * sign, -1, -0.35 } },
    coif.domain.directional { priority = 1, box = band(jaw - 14, ears + 1), direction = { 0.05 * sign, -1, -0.05 } },
  }
end

local hair = head:scalp():parting { head:at("forehead"), head:at("vertex", { 0, 0, 1 }), head:at("occiput", { 0, 6, 0 }) }
  :guides { count = 800, length = 40, stiffness = 1.6, lay_from = head:at("forehead", { 0, 0, 3 }), lay_amount = 0.7 }
  :grow {
    locals = {
      { where = function(root) return root.x >= 0 end, queue = side(1) },
      { where = function(root) return root.x < 0 end,  queue = side(-1) },
    },
  }
  :lift { by = p.lift, from = 0.72, roots = 5 }
  :taper { width = p.flare, from = 0.45, roots = 5 }
  :bend { angle = 24, towards = { 0, 0, 1 }, from = 0.6 }
  :fill { strands = p.strands, noise = 0.012, length_variation = 0.04, thickness = 0.8, material = looks.auburn }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
