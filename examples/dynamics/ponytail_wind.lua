-- ponytail_wind.lua: a ponytail in gusty wind from the side; what is under the tie is pinned.
local looks = require "coif/looks"

local p = coif.params {
  wind    = { 700, min = 0, max = 3000, unit = "cm/s^2", doc = "mean strength of the wind" },
  strands = { 8000, min = 300, max = 40000, doc = "how many strands" },
}

local head = coif.head()
local tie  = head:at("occiput", { 0, 5.5, -2.2 })
local behind = coif.box { min = { -25, -100, -60 }, max = { 25, 30, tie.z - 0.5 } }

local tail = head:scalp()
  :guides { count = 160, length = 46, length_variation = 0.2, step = 1, stiffness = 1.5,
    lay_from = head:at("chin", { 0, 2, 6 }), lay_amount = 0.85 }
  :grow {
    global = coif.queue {
      coif.domain.directional { box = behind, direction = { 0, -1, -0.06 }, strength = 0.6 },
      coif.domain.gather { core = tie, core_radius = 1, scatter = -0.2, direction = { 0, 0.25, -1 } },
    },
  }
  :simulate {
    duration = 2, rate = 12, hold = 5,
    pinned = { coif.box { min = { -30, -30, tie.z - 0.8 }, max = { 30, 40, 40 } } },
    forces = {
      coif.force.gravity {},
      coif.force.wind { direction = { 1, 0.15, 0 }, strength = p.wind, gust = 0.8, period = 0.8 },
    },
  }
  :fill { strands = p.strands, clump = 0.35, clump_start = 0.4, thickness = 0.7, material = looks.chestnut }

return coif.scene { head, tail, views = { "back", "left" } }
