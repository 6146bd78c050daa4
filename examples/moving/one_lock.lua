-- one_lock.lua: a single lock on the crown that leans from side to side, posed three times.
-- After the first character of Ren, Zhao, Geng 2010.
local p = coif.params {
  sway   = { 55, min = 0, max = 80, unit = "deg", doc = "how far the lock leans" },
  frames = { 40, min = 8, max = 240, doc = "frames of one sway" },
  hair   = { "#e0703a", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, tip_colour = "#f6b25e", shine = 0.6 }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

-- The lock stands up from the crown, and bends to the head's left by `lean` degrees at its tip.
local function sprout(lean, nod)
  local root   = at(180, 82)
  local points = { root }
  local place  = root
  for i = 1, 8 do
    local t = i / 8
    local side, front = math.rad(lean * t ^ 1.4), math.rad(nod * t ^ 1.4 - 25)
    place += 2.0 * vector.create(math.sin(side), math.cos(side) * math.cos(front), math.cos(side) * math.sin(front))
    table.insert(points, place)
  end
  return coif.tuft {
    stroke = points, up = { 0, 0, 1 }, sides = 24, material = look, bury = true,
    profile = { { 0, 2.4, 1.8 }, { 0.22, 4.0, 2.8 }, { 0.55, 4.4, 2.6 }, { 0.8, 2.9, 1.8 }, { 1, 0, 0 } },
  }
end

local moving = coif.animate {
  states = { sprout(8, 75), sprout(p.sway, 85), sprout(-p.sway, 85) },
  path   = coif.path { states = { 1, 2, 1, 3 }, closed = true, frames = p.frames },
  loop   = true,
}

-- The hair that does not move: a cap and a short fringe.
local function fringe(azimuth, lean, length)
  return coif.tuft {
    stroke = { at(azimuth, 64), at(azimuth, 50, 1.8), at(azimuth + 0.4 * lean, 34, 1.7), at(azimuth + lean, 34 - length, 1.0) },
    profile = { { 0, 1.4, 0.8 }, { 0.45, 4.6, 1.3 }, { 0.8, 2.8, 0.9 }, { 1, 0, 0 } },
    bend = 40, material = look, lift = true,
  }
end
local front = {}
for _, lock in { { -58, -6, 24 }, { -38, -8, 17 }, { -18, -8, 14 }, { 2, 8, 13 }, { 21, 8, 15 }, { 40, 8, 18 }, { 59, 6, 24 } } do
  table.insert(front, fringe(lock[1], lock[2], lock[3]))
end

return coif.scene {
  head, coif.cap { thickness = 0.8, material = p.hair }, front, moving,
  shading = "toon", skin = "#f3cfb4", views = { "front", "three-quarter" }, still = math.ceil(p.frames / 4),
}
