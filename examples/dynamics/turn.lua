-- turn.lua: the head turns quickly and stops; long hair lags behind, swings past and comes to rest.
local looks = require "coif/looks"

local p = coif.params {
  turn    = { 60, min = -90, max = 90, unit = "degrees", doc = "how far the head turns" },
  strands = { 8000, min = 300, max = 40000, doc = "how many strands" },
}

local head = coif.head()
local turn = head:motion { { time = 0 }, { time = 0.2 }, { time = 0.55, yaw = p.turn }, { time = 2, yaw = p.turn }, rate = 12 }

local hair = head:scalp():parting { head:at("forehead"), head:at("vertex") }
  :guides { count = 220, length = 38, length_variation = 0.1, step = 1.5, stiffness = 2.5,
    lay_from = head:at("vertex", { 0, 1, 3 }), lay_amount = 0.9 }
  :grow {
    global = coif.queue {
      coif.domain.directional { box = head:box("all"), direction = { 0, -1, -0.1 }, strength = 0.6 },
    },
  }
  :simulate { motion = turn, hold = 4, drag = 2 }
  :fill { strands = p.strands, thickness = 0.7, clump = 0.3, clump_start = 0.3, material = looks.brown }

return coif.scene { head, hair, motion = turn, views = { "back", "front" } }
