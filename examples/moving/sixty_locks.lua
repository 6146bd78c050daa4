-- sixty_locks.lua: a full mane of 60 locks in the wind; a gust goes through it from one ear to the other.
local p = coif.params {
  wind   = { 1.0, min = 0, max = 1.5, doc = "how far the wind pushes" },
  frames = { 48, min = 8, max = 240, doc = "frames of one gust" },
  roots  = { "#4b2a63", doc = "colour of the inner locks" },
  tips   = { "#f0a35e", doc = "colour of the tips" },
}

local head = coif.head { style = "cartoon" }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

-- Five rows from the nape up to the crown: elevation, how many, length, width, colour.
---@type any
local rows = {
  { -8, 14, 10.5, 3.7, "#4b2a63" },
  { 14, 13, 12.5, 4.1, "#5f2f74" },
  { 34, 12, 14.0, 4.6, "#763681" },
  { 54, 11, 14.5, 5.2, "#8f3f8a" },
  { 80, 10, 14.0, 6.2, "#a84b8c" },
}
local looks = {}
for row, place in rows do
  looks[row] = coif.material.tuft { colour = row == 1 and p.roots or place[5], tip_colour = p.tips, shine = 0 }
end

-- Where the locks grow, from the head's left ear around the back to the right one, so that a gust can go along them.
---@type any
local places = {}
for row, place in rows do
  for k = 0, place[2] - 1 do
    local azimuth = 66 + (294 - 66) * (k + 0.5 * (row % 2)) / (place[2] - 1 + 0.5)
    table.insert(places, { azimuth = azimuth, row = row, length = place[3] * (1 - 0.07 * (k % 3)) })
  end
end
table.sort(places, function(a, b)
  if a.azimuth ~= b.azimuth then return a.azimuth < b.azimuth end
  return a.row < b.row
end)

-- A lock from its root over the skull and down; `push` moves its tip to the head's left, `lift` up and out.
local function fall(place, push, lift)
  local azimuth, elevation, width = place.azimuth, rows[place.row][1], rows[place.row][4]
  local below = math.min(elevation - 22, 6.0)
  local edge  = at(azimuth, below, 1.1 + 0.34 * place.row)
  local out   = vector.normalize(vector.create(edge.x, 0, edge.z))
  local points = {
    at(azimuth, elevation), at(azimuth, elevation - 6, 0.7 + 0.1 * place.row),
    at(azimuth, 0.7 * elevation + 0.3 * below, 0.9 + 0.32 * place.row),
    at(azimuth, 0.35 * elevation + 0.65 * below, 1.0 + 0.35 * place.row), edge,
  }
  for i = 1, 4 do
    local t = i / 4
    local free = t ^ 1.6
    table.insert(points, edge + vector.create(push * free, 0.45 * lift * free - place.length * t, 0)
      + out * (0.12 * place.length * t + lift * free))
  end
  return coif.tuft {
    stroke = points, sides = 14, up = out, material = looks[place.row], bury = true,
    profile = { { 0, 0, 0 }, { 0.16, 0.8 * width, 1.1 }, { 0.42, width, 1.5 }, { 0.7, 0.8 * width, 1.2 }, { 1, 0, 0 } },
  }
end

local function mane(push, lift)
  local all = nil ---@type any
  for _, place in places do
    local own  = 0.75 + 0.1 * place.row
    local lock = fall(place, push * p.wind * own, lift * p.wind * own)
    all = all and all + lock or lock
  end
  return all
end

local moving = coif.animate {
  states  = { mane(0, 0), mane(5.5, 3.0), mane(-2.5, 0.7) },
  path    = coif.path { states = { 1, 2, 1, 3 }, closed = true, frames = p.frames },
  stagger = 0.013, loop = true,
}

local front = {}
for _, lock in { { -62, -4, 66 }, { -46, -6, 50 }, { -30, -8, 38 }, { -13, -8, 32 }, { 4, -5, 30 }, { 20, 6, 33 }, { 35, 7, 39 }, { 50, 6, 51 }, { 64, 4, 67 } } do
  table.insert(front, coif.tuft {
    stroke = {
      at(lock[1], 84), at(lock[1], 62, 2.2), at(lock[1] + 0.4 * lock[2], 42, 2.1), at(lock[1] + lock[2], 38 - lock[3], 1.1),
    },
    profile = { { 0, 1.4, 0.8 }, { 0.45, 5.2, 1.2 }, { 0.8, 2.8, 0.8 }, { 1, 0, 0 } },
    bend = 40, material = looks[5], lift = true,
  })
end

return coif.scene {
  head, coif.cap { thickness = 0.9, material = "#763681" }, front, moving,
  shading = "toon", skin = "#f0cdae", views = { "back", "three-quarter", "front" }, still = math.ceil(p.frames / 4),
}
