-- many_locks.lua: a mane of locks in the wind, each a little later than the one before it.
-- After the third character of Ren, Zhao, Geng 2010, whose method took a few locks only.
local p = coif.params {
  wind   = { 1.0, min = 0, max = 1.6, doc = "how far the wind pushes" },
  frames = { 48, min = 8, max = 240, doc = "frames of one gust" },
  hair   = { "#3f6fb5", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, tip_colour = "#7fc4e8", shine = 0.5 }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

-- A lock from its root over the skull and down; `push` moves its tip to the head's left, `lift` up and out.
local function fall(azimuth, elevation, length, width, push, lift)
  local root = at(azimuth, elevation)
  local edge = at(azimuth, math.min(elevation - 24, 8), 1.5)
  local out  = vector.normalize(vector.create(edge.x, 0, edge.z))
  local points = { root, at(azimuth, elevation - 7, 1.0), at(azimuth, 0.5 * (elevation + math.min(elevation - 24, 8)), 1.9), edge }
  for i = 1, 5 do
    local t = i / 5
    local free = t ^ 1.6
    table.insert(points, edge + vector.create(push * free, -length * t, 0) + out * (0.16 * length * t + lift * free)
      + vector.create(0, 0.5 * lift * free, 0))
  end
  return coif.tuft {
    stroke = points, sides = 20, up = out, material = look, bury = true,
    profile = { { 0, 0, 0 }, { 0.16, 0.8 * width, 1.3 }, { 0.4, width, 1.8 }, { 0.7, 0.85 * width, 1.5 }, { 1, 0, 0 } },
  }
end

-- All locks in one pose: three rows from ear to ear behind the head.
local function mane(push, lift)
  local all = nil ---@type any
  for row, place in { { 20, 14, 4.8, 9 }, { 46, 15, 5.6, 9 }, { 76, 13, 6.4, 9 } } do
    for k = 0, place[4] - 1 do
      local azimuth = 72 + (288 - 72) * k / (place[4] - 1)
      local lock = fall(azimuth, place[1], place[2] - 0.6 * (k % 2), place[3], push * p.wind, lift * p.wind)
      all = all and all + lock or lock
    end
  end
  return all
end

local moving = coif.animate {
  states  = { mane(0, 0), mane(6.5, 3.2), mane(-2.5, 0.8) },
  path    = coif.path { states = { 1, 2, 1, 3 }, closed = true, frames = p.frames },
  stagger = 0.02, loop = true,
}

local front = {}
for _, lock in { { -58, -4, 34 }, { -40, -6, 19 }, { -22, -7, 15 }, { -3, -6, 13 }, { 16, 6, 15 }, { 35, 7, 19 }, { 56, 5, 34 } } do
  table.insert(front, coif.tuft {
    stroke = {
      at(lock[1], 64), at(lock[1], 50, 1.9), at(lock[1] + 0.4 * lock[2], 34, 1.8), at(lock[1] + lock[2], 34 - lock[3], 1.0),
    },
    profile = { { 0, 1.4, 0.8 }, { 0.45, 4.8, 1.3 }, { 0.8, 2.8, 0.9 }, { 1, 0, 0 } },
    bend = 40, material = look, lift = true,
  })
end

return coif.scene {
  head, coif.cap { thickness = 0.9, material = p.hair }, front, moving,
  shading = "toon", skin = "#eac39f", views = { "front", "three-quarter", "back" }, still = math.ceil(p.frames / 4),
}
