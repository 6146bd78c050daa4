-- pigtails.lua: two low pigtails from a middle parting that runs down to the nape.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 46, min = 20, max = 90, unit = "cm", doc = "longest strand" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head    = coif.head()
local parting = head:parting { head:at("forehead"), head:at("vertex"), head:at("occiput"), head:at("nape") }

local function side(sign)
  local tie = head:at("nape", { 7.2 * sign, 1.5, 2 })
  return coif.queue {
    coif.domain.gather { priority = 3, core = head:at("nape", { 5 * sign, 5, 2 }), core_radius = 3.5 },
    coif.domain.gather { priority = 2, core = tie, core_radius = 0.9, scatter = -0.15, direction = { 0.35 * sign, -1, 0.15 } },
    coif.domain.directional { priority = 1, box = head:box("all"), direction = { 0.12 * sign, -1, 0.3 }, strength = 0.5 },
  }
end

local hair = head:scalp():parting(parting)
  :guides { count = 800, length = p.length, length_variation = 0.25, stiffness = 1.5,
    lay_from = head:at("forehead", { 0, 2, 3 }), lay_amount = 0.8 }
  :grow {
    locals = {
      { where = function(root) return parting:side(root) >= 0 end, queue = side(1) },
      { where = function(root) return parting:side(root) < 0 end,  queue = side(-1) },
    },
  }
  :natural {
    coif.domain.wave { box = head:box("below"), period = 8, radius = 0.5, phase_variation = 0.2, smooth_end = 0 },
  }
  :fill { strands = p.strands, clump = 0.4, clump_start = 0.4, thickness = 0.6, material = looks.red }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
