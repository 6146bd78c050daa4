-- caged.lua: a long straight hairstyle shaped by a cage of scattered control points: no grid, a point where one is wanted.
-- Points with a target are pulled there, the others hold their place, and everything inside follows smoothly.
local looks = require "coif/looks"

local p = coif.params {
  crown   = { 2, min = 0, max = 8, unit = "cm", doc = "how far the crown is lifted" },
  tips    = { 11, min = -16, max = 16, unit = "cm", doc = "how far the tips swing to the side" },
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

local straight = head:scalp():parting(parting)
  :guides { count = 800, length = 40, length_variation = 0.06, stiffness = 1.2, lay_from = head:at("forehead", { 0, 0, 3 }), lay_amount = 0.75 }
  :grow {
    global = coif.queue {
      coif.domain.directional { box = { min = { -60, -120, -60 }, max = { 60, crown, 60 } }, direction = { 0, -1, -0.02 } },
    },
    locals = {
      { where = function(root) return parting:side(root) >= 0 end, queue = side(1) },
      { where = function(root) return parting:side(root) < 0 end,  queue = side(-1) },
    },
  }

-- the control points: one above the crown, four at the ears, four at the shoulders, four below the tips
local function spot(name, x, y, z, dx, dy)
  local at = vector.create(x, y, z)
  if dx == 0 and dy == 0 then return { name = name, at = at } end
  return { name = name, at = at, to = at + vector.create(dx, dy, 0) }
end

local top, ear, shoulder = head:at("vertex", { 0, 8, 0 }), head:at("left_ear").y, head:at("chin").y - 6
local tips = head:at("nape").y - 42
local points = { spot("crown", 0, top.y, 0, 0, p.crown) }
for _, x in { 1, -1 } do
  for _, z in { 1, -1 } do
    local corner = (x > 0 and "left " or "right ") .. (z > 0 and "front " or "back ")
    table.insert(points, spot(corner .. "ear", 17 * x, ear, 18 * z, 0, 0))
    table.insert(points, spot(corner .. "shoulder", 30 * x, shoulder, 24 * z, -2 * x, 0))
    table.insert(points, spot(corner .. "tips", 34 * x, tips, 28 * z, p.tips, 0.2 * p.tips * x))
  end
end
local cage = coif.cage(points)

local hair = straight
  :deform { cage, roots = 4 }
  :fill { strands = p.strands, noise = 0.015, flyaway = 0.01, thickness = 0.7, material = looks.chestnut }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
