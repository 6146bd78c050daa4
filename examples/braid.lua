-- braid.lua: combed back to the nape, then a three-strand braid. Each third of the hair has its own gather domain beside
-- the others and follows one of three curves that run round each other.
local looks = require "coif/looks"

local p = coif.params {
  length  = { 62, min = 40, max = 100, unit = "cm", doc = "longest strand" },
  turn    = { 9, min = 4, max = 16, unit = "cm", doc = "length of one whole turn of the braid" },
  width   = { 1.25, min = 0.5, max = 3, unit = "cm", doc = "how far the three lie apart" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head = coif.head()
local tie  = head:at("nape", { 0, 3, -3.2 })
local tail = coif.box { min = { -20, -120, -50 }, max = { 20, tie.y - 0.5, 0 } }

-- thirds of the head, from right to left
local function third(root) return root.x < -3.2 * head.scale and 1 or root.x < 3.2 * head.scale and 2 or 3 end

local function queue(k)
  return coif.queue {
    coif.domain.gather { priority = 2, core = tie + vector.create(0.5 * (k - 2), 0, 0), core_radius = 0.6,
      scatter = 0.05, direction = { 0, -1, -0.1 } },
    coif.domain.directional { priority = 1, box = head:box("all"), direction = { 0, -1, -0.06 } },
  }
end

local guides = head:scalp():guides { count = 600, length = p.length, length_variation = 0.06, stiffness = 1.5,
  lay_from = head:at("forehead", { 0, 0, 3 }), lay_amount = 0.85 }
local locals = {}
for k = 1, 3 do
  locals[k] = { where = function(root) return third(root) == k end, queue = queue(k) }
end
local axis = guides:grow { locals = locals }

-- The curve of a three-strand braid: once to and fro across while twice in and out.
for k = 1, 3 do
  axis = axis:natural {
    where = function(root) return third(root) == k end,
    coif.domain.natural {
      box = tail, period = p.turn, smooth = 0.06, smooth_end = 0,
      curve = function(u)
        local a = 2 * math.pi * (u + k / 3)
        return 0.55 * p.width * math.sin(2 * a), p.width * math.sin(a)
      end,
    },
  }
end

local hair = axis:fill { strands = p.strands, clump = 0.5, clump_start = 0.4, noise = 0.008, thickness = 0.5, material = looks.blonde }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
