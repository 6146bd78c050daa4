-- bob.lua: a chin-long bob with a blunt fringe; the tips turn in. Strands end where their last domain ends, so the
-- boxes cut the hem.
local looks = require "coif/looks"

local p = coif.params {
  hem     = { 3.5, min = -4, max = 12, unit = "cm", doc = "height of the hem over the chin, downwards" },
  fringe  = { 0.5, min = -2, max = 4, unit = "cm", doc = "height of the fringe over the brows" },
  strands = { 40000, min = 1000, max = 200000, doc = "how many strands" },
}

local head   = coif.head()
local line   = head:at("forehead")
local crown  = head:at("vertex", { 0, -4.5, 0 }).y
local jaw    = head:at("chin", { 0, 3.5, 0 }).y
local hem    = head:at("chin", { 0, -p.hem, 0 }).y
local brow   = head:at("forehead", { 0, p.fringe - 6.2, 0 }).y

local function band(low, high) return { min = { -60, low, -60 }, max = { 60, high, 60 } } end

-- the fringe is a wedge from the hairline towards the crown; behind it both grow for a little, so that no gap shows
local function depth(at) return (at.z - line.z) / head.scale + 6.5 - 0.9 * math.abs(at.x) / head.scale end
local scalp = head:scalp()
local front = scalp:where(function(at) return at.y > line.y - 2.5 and depth(at) > 0 end)
local rest  = scalp:where(function(at) return at.y < line.y - 2.5 or depth(at) < 1.5 end)

-- off the middle, down to the jaw, inward to the hem; roots at the sides begin with the second
local function queue(sign, above)
  local top  = coif.domain.directional { priority = 3, box = band(crown, 40), direction = { 0.5 * sign, -1, -0.35 } }
  local fall = coif.domain.directional { priority = 2, box = band(jaw, crown + 1), direction = { 0, -1, 0.02 } }
  local turn = coif.domain.directional { priority = 1, box = band(hem, jaw + 1), direction = { -0.35 * sign, -1, 0.1 } }
  return above and coif.queue { top, fall, turn } or coif.queue { fall, turn }
end

local locals = {}
for _, sign in { 1, -1 } do
  for _, above in { true, false } do
    local function of(root) return (root.x >= 0) == (sign > 0) and (root.y > crown) == above end
    table.insert(locals, { where = of, queue = queue(sign, above) })
  end
end

local bob = rest
  :guides { count = 700, length = 45, stiffness = 1.5, lay_from = head:at("forehead", { 0, 0, 3 }), lay_amount = 0.7 }
  :grow { locals = locals }
  :fill { strands = p.strands * 0.85 // 1, noise = 0.01, length_variation = 0.03, thickness = 0.8, material = looks.black }

local fringe = front
  :guides { count = 150, length = 14, stiffness = 1.5, lay = { 0, -0.2, 1 }, lay_amount = 0.75 }
  :grow { global = coif.queue { coif.domain.directional { box = band(brow, 40), direction = { 0, -1, 0.25 } } } }
  :fill { strands = p.strands * 0.15 // 1, noise = 0.01, length_variation = 0.03, thickness = 0.6, material = looks.black }

return coif.scene { head, bob, fringe, views = { "front", "three-quarter", "left", "back" } }
