-- sway.lua: long hair that swings from side to side between two grooms, while the head tilts a little.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 42, min = 20, max = 70, unit = "cm", doc = "length of the hair" },
  lean    = { 0.55, min = 0, max = 1.5, doc = "how far it swings" },
  strands = { 9000, min = 500, max = 40000, doc = "how many strands" },
}

local head = coif.head()
local below = coif.box { min = { -60, -120, -60 }, max = { 60, head:at("nape").y + 4, 60 } }

local guides = head:scalp():parting { head:at("forehead"), head:at("vertex") }
  :guides { count = 220, length = p.length, length_variation = 0.1, stiffness = 2.5,
    lay_from = head:at("vertex", { 0, 1, 3 }), lay_amount = 0.9 }

-- The same hair, falling to one side or the other.
local function groom(side)
  return guides:grow {
    global = coif.queue {
      coif.domain.directional { box = head:box("all"), direction = { 0, -1, -0.1 }, strength = 0.5 },
      coif.domain.directional { box = below, direction = { side * p.lean, -1, 0.05 }, strength = 0.9 },
    },
  }
end

local hair = coif.clip { groom(1), groom(-1), seconds = 0.75, loop = true }
  :natural { coif.domain.wave { box = below, period = 9, radius = 0.5, smooth = 0.3 } }
  :fill { strands = p.strands, thickness = 0.7, clump = 0.3, clump_start = 0.3, material = looks.chestnut }

local tilt = head:motion {
  { time = 0, roll = -4 }, { time = 0.75, roll = 4 }, { time = 1.5, roll = -4 }, loop = true,
}

return coif.scene { head, hair, motion = tilt, still = 1, views = { "back", "three-quarter", "front" } }
