-- look_around.lua: a cartoon head that looks around and nods; its hair goes with it.
local p = coif.params {
  hair = { "#c8743a", doc = "colour of the hair" },
  yaw  = { 55, min = 5, max = 90, unit = "degrees", doc = "how far it turns to each side" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, shine = 0.6 }

local function lock(azimuth, elevation, points)
  local stroke = { { azimuth = azimuth, elevation = elevation } }
  for _, point in points do
    table.insert(stroke, { azimuth = point[1], elevation = point[2], height = point[3] })
  end
  return coif.tuft { stroke = stroke, material = look, lift = true,
    profile = { { 0, 2, 1 }, { 0.4, 4.6, 1.7 }, { 0.8, 2.8, 1.2 }, { 1, 0, 0 } } }
end

-- From temple to temple around the back, and a fringe between.
local side = lock(75, 38, { { 78, 22, 2 }, { 80, -8, 2 }, { 76, -38, 2.4 }, { 70, -52, 3.4 } })
local back = lock(180, 36, { { 180, 16, 2 }, { 180, -14, 2 }, { 180, -40, 2.4 }, { 180, -52, 3.6 } })
local around = coif.fill { side, back, side:mirrored(), around = 22 }
local fringe = {
  lock(-8, 62, { { -20, 46, 2.4 }, { -34, 26, 2 }, { -42, 10, 1.4 } }),
  lock(4, 64, { { -6, 48, 2.6 }, { -16, 28, 2 }, { -20, 12, 1.2 } }),
  lock(14, 64, { { 8, 48, 2.6 }, { 2, 30, 2 }, { 2, 15, 1.2 } }),
  lock(22, 62, { { 24, 46, 2.4 }, { 26, 30, 2 }, { 26, 14, 1.2 } }),
  lock(30, 58, { { 42, 42, 2.2 }, { 52, 24, 1.8 }, { 56, 6, 1.4 } }),
}

-- Left, right, a nod, and the same again.
local motion = head:motion {
  { time = 0 },
  { time = 0.5, yaw = p.yaw, roll = 4 },
  { time = 0.8, yaw = p.yaw, roll = 4 },
  { time = 1.5, yaw = -p.yaw, roll = -4 },
  { time = 1.8, yaw = -p.yaw, roll = -4 },
  { time = 2.2, pitch = 4 },
  { time = 2.5, pitch = 18 },
  { time = 2.75, pitch = 2 },
  { time = 3 },
  loop = true,
}

return coif.scene {
  head, coif.cap { thickness = 0.8, material = look }, around, fringe,
  motion = motion, still = 14, shading = "toon", skin = "#f6d7bd", views = { "front", "three-quarter", "left" },
}
