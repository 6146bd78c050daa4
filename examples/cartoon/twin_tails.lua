-- twin_tails.lua: two long tails tied high at the sides, a fringe, and wisps before the ears.
local p = coif.params {
  length = { 30, min = 12, max = 60, unit = "cm", doc = "length of the tails" },
  hair   = { "#3f7fc4", doc = "colour of the hair" },
  ties   = { "#d8344f", doc = "colour of the ties" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, shine = 0.6 }

-- A place over the head: degrees from the face to its left, degrees up, cm over the skin.
local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

local cap = coif.cap { thickness = 0.7, material = look }

-- A tail is a fan of locks from one knot.
local knot = at(72, 46, 0)
local out  = at(72, 46, 2.6)
local function lock(side, forward, width, reach)
  local k = p.length / 30
  return coif.tuft {
    stroke = {
      knot, out + vector.create(1.2, 0.8, 0.4 * forward),
      out + vector.create(4.2 + side, -3.5 * k, forward),
      out + vector.create(5.4 + 1.4 * side, -13 * k * reach, 1.5 * forward),
      out + vector.create(4.0 + 1.6 * side, -23 * k * reach, 1.9 * forward),
      out + vector.create(5.2 + 1.9 * side, -30 * k * reach, 2.2 * forward),
    },
    profile = { { 0, 0.9, 0.9 }, { 0.12, 1.6, 1.4 }, { 0.45, width, 2.2 }, { 0.8, 0.7 * width, 1.4 }, { 1, 0, 0 } },
    material = look, bury = true,
  }
end
local tail = lock(0, 0, 4.4, 1) + lock(1.3, 1.2, 3.2, 0.86) + lock(-1.0, 1.7, 3.0, 0.92)
  + lock(1.0, -1.6, 3.2, 0.9) + lock(-1.2, -1.4, 3.0, 0.8)
local tie = coif.bun { position = at(72, 46, 1.7), axis = at(72, 46, 2) - at(72, 46, 1), radius = 2.1, length = 1.9, material = p.ties }
local tie_right = coif.bun {
  position = at(-72, 46, 1.7), axis = at(-72, 46, 2) - at(-72, 46, 1), radius = 2.1, length = 1.9, material = p.ties,
}

-- The fringe: three locks by hand, the rest between them.
local function fringe(azimuth, lean, length)
  return coif.tuft {
    stroke = {
      at(azimuth, 62), at(azimuth, 50, 2.0), at(azimuth + 0.3 * lean, 34, 1.9), at(azimuth + 0.7 * lean, 20, 1.3),
      at(azimuth + lean, 20 - length, 0.8),
    },
    profile = { { 0, 1.5, 0.8 }, { 0.4, 4.2, 1.3 }, { 0.75, 3.0, 0.9 }, { 1, 0, 0 } },
    bend = 40, material = look, lift = true,
  }
end
local front = {}
for _, lock in { { -56, -6, 22 }, { -36, -4, 16 }, { -18, 6, 14 }, { 2, 9, 17 }, { 21, -5, 13 }, { 39, 4, 17 }, { 57, 6, 23 } } do
  table.insert(front, fringe(lock[1], lock[2], lock[3]))
end

-- Combed from the parting at the back to the knot.
local combed = {}
for _, elevation in { 66, 44, 22, 2, -18, -32 } do
  local root   = at(180, elevation)
  local points = { root }
  for _, t in { 0.25, 0.5, 0.75 } do
    local way = vector.normalize(root + (knot - root) * t - head.centre)
    table.insert(points, at(math.deg(math.atan2(way.x, way.z)), math.deg(math.asin(way.y)), 0.9))
  end
  table.insert(points, out)
  local lock = coif.tuft {
    stroke = points, material = look, bury = true, bend = 30,
    profile = { { 0, 1.5, 0.6 }, { 0.3, 4.6, 1.3 }, { 0.7, 3.0, 1.2 }, { 1, 0.5, 0.5 } },
  }
  table.insert(combed, lock)
  table.insert(combed, lock:mirrored())
end

-- A wisp before each ear.
local wisp = coif.tuft {
  stroke = { at(72, 34), at(70, 18, 1.4), at(67, -4, 1.2), at(62, -26, 1.4), at(58, -44, 1.6) },
  profile = { { 0, 1, 0.6 }, { 0.4, 2.6, 0.9 }, { 0.8, 1.4, 0.6 }, { 1, 0, 0 } },
  material = look, lift = true,
}

return coif.scene {
  head, cap, combed, tail, tail:mirrored(), tie, tie_right, front, wisp, wisp:mirrored(),
  shading = "toon", skin = "#f3cfb4", views = { "front", "three-quarter", "left", "back" },
}
