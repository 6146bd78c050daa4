-- bun_and_tail.lua: a bun with a tail that trails behind as the head turns.
-- After the second character of Ren, Zhao, Geng 2010; there hair moves apart from the head.
local p = coif.params {
  turn = { 38, min = 0, max = 70, unit = "deg", doc = "how far the head turns to each side" },
  lag  = { 1.0, min = 0, max = 1.5, doc = "how far the tail trails" },
  hair = { "#7a3b2e", doc = "colour of the hair" },
  tie  = { "#2f9e8f", doc = "colour of the tie" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, tip_colour = "#b9674a", shine = 0.6 }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

-- Combed back from the hairline to the knot.
local knot, axis = at(180, 52, 0.4), vector.normalize(vector.create(0, 0.75, -1))
local combed = {}
for _, place in { { 0, 46, 4.6 }, { 22, 44, 4.8 }, { 45, 40, 5 }, { 66, 32, 5 }, { 86, 22, 5 }, { 106, 4, 5.4 }, { 130, -16, 5.4 }, { 155, -26, 5.2 }, { 180, -28, 5 } } do
  local points = { at(place[1], place[2]) }
  for _, t in { 0.22, 0.45, 0.68, 0.86 } do
    local way = vector.normalize(points[1] + (knot - points[1]) * t - head.centre)
    table.insert(points, at(math.deg(math.atan2(way.x, way.z)), math.deg(math.asin(way.y)), 0.8))
  end
  table.insert(points, knot + 0.5 * axis)
  local lock = coif.tuft {
    stroke = points, bury = true, material = look, bend = 30,
    profile = { { 0, 0.6 * place[3], 0.8 }, { 0.35, place[3], 1.1 }, { 0.8, 0.55 * place[3], 1 }, { 1, 0.8, 0.8 } },
  }
  table.insert(combed, lock)
  if place[1] ~= 0 and place[1] ~= 180 then table.insert(combed, lock:mirrored()) end
end
local bun = coif.bun { position = knot + 2.4 * axis, axis = axis, radius = 3.6, length = 5.6, grooves = 8, swirl = 140, material = look }
local tie = coif.bun { position = knot + 0.3 * axis, axis = axis, radius = 2.9, length = 1.5, material = p.tie }

-- The tail falls out of the bun; `side` and `back` are how far its tip is pushed aside and lifted off the back.
local function tail(side, back)
  local root   = at(180, 52)
  local out    = knot + 4.6 * axis
  local points = { root, knot + 2.2 * axis, out }
  for i = 1, 8 do
    local t = i / 8
    local rise = 1.6 * math.sin(3.1 * t)
    table.insert(points, out + vector.create(side * t ^ 1.5, rise - 23 * t ^ 1.2 + 0.4 * back * t * t, -4.2 * math.sin(1.7 * t) - back * t ^ 1.4))
  end
  return coif.tuft {
    stroke = points, sides = 28, up = { 0, 0.5, -1 }, material = look, bury = true,
    profile = { { 0, 1.2, 1.2 }, { 0.18, 2.6, 2.4 }, { 0.45, 6.0, 4.0 }, { 0.78, 4.6, 3.0 }, { 1, 0, 0 } },
  }
end

local turn = head:motion {
  { time = 0, yaw = -p.turn }, { time = 0.9, yaw = p.turn }, { time = 1.1, yaw = p.turn },
  { time = 2.0, yaw = -p.turn }, { time = 2.2, yaw = -p.turn }, loop = true,
}
local moving = coif.animate {
  states = { tail(0, 0), tail(13, 1), tail(-13, 1), tail(0, 9) },
  motion = turn, loop = true,
  lag    = { hold = 8, drag = 3, amount = p.lag },
}

local function fringe(azimuth, lean, length, width)
  return coif.tuft {
    stroke = {
      at(12 + 0.2 * azimuth, 60), at(12 + 0.55 * azimuth, 50, 2.2), at(6 + azimuth, 34, 2.2),
      at(4 + azimuth + 0.6 * lean, 20, 1.5), at(azimuth + lean, 20 - length, 0.9),
    },
    profile = { { 0, 1, 0.8 }, { 0.45, width, 1.4 }, { 0.8, 0.6 * width, 1 }, { 1, 0, 0 } },
    bend = 40, material = look, lift = true,
  }
end
local front = {
  fringe(-52, -8, 26, 4.6), fringe(-36, -10, 17, 4.6), fringe(-20, -10, 13, 4.4), fringe(-4, -8, 10, 4),
  fringe(22, 12, 14, 4.2), fringe(38, 16, 24, 4.4),
}

return coif.scene {
  head, coif.cap { thickness = 0.7, material = p.hair }, combed, bun, tie, front, moving,
  shading = "toon", skin = "#f3cfb4", views = { "back", "three-quarter", "front" }, motion = turn, still = 14,
}
