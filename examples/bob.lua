-- bob.lua: a chin-long bob with a blunt fringe; the tips turn in.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 25, min = 16, max = 40, unit = "cm", doc = "length at the sides" },
  fringe  = { 9, min = 5, max = 14, unit = "cm", doc = "length of the fringe" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head  = coif.head()
local line  = head:at("forehead")
local crown = head:at("vertex", { 0, -4.5, 0 }).y
local jaw   = head:at("chin", { 0, 5, 0 }).y

local scalp  = head:scalp()
local front  = scalp:where(function(at) return at.z > line.z - 3.5 and math.abs(at.x) < 5.2 * head.scale and at.y > line.y - 2 end)
local rest   = scalp - front

-- off the middle: one local queue for each side, on the top of the head
local function side(sign)
  return coif.queue {
    coif.domain.directional {
      box = { min = { -40, crown, -40 }, max = { 40, 40, 40 } }, direction = { 0.5 * sign, -1, -0.2 },
    },
  }
end

-- down to the jaw, and from there inward
local function inward(sign)
  return coif.domain.directional {
    box = { min = { 0, -60, -60 }, max = { 60 * sign, jaw, 60 } }, direction = { -0.5 * sign, -1, 0.1 },
  }
end
local fall = coif.queue {
  coif.domain.directional { box = { min = { -60, jaw, -60 }, max = { 60, crown, 60 } }, direction = { 0, -1, 0.02 } },
  inward(1),
  inward(-1),
}

local look = looks.black
local bob = rest
  :guides { count = 700, length = p.length, length_variation = 0.05, stiffness = 1.5, lay = { 0, -1, -0.3 }, lay_amount = 0.6 }
  :grow {
    global = fall,
    locals = {
      { where = function(root) return root.x >= 0 end, queue = side(1) },
      { where = function(root) return root.x < 0 end,  queue = side(-1) },
    },
  }
  :fill { strands = p.strands * 0.85 // 1, noise = 0.012, length_variation = 0.02, thickness = 0.8, material = look }

local fringe = front
  :guides { count = 120, length = p.fringe, length_variation = 0.03, stiffness = 2, lay = { 0, -0.2, 1 }, lay_amount = 0.6 }
  :grow { global = coif.queue { coif.domain.directional { box = head:box("all"), direction = { 0, -1, 0.3 } } } }
  :fill { strands = p.strands * 0.15 // 1, noise = 0.012, length_variation = 0.02, thickness = 0.5, material = look }

return coif.scene { head, bob, fringe, views = { "front", "three-quarter", "left", "back" } }
