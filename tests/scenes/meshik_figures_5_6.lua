-- Figures 5 and 6 of Ren, Zhao, Geng 2010: a lock of 20 control points and 40 samples around, which is 1,520 triangles, in
-- three states, and an animation of 40 frames with its tip along one path, of which every fifth is shown. The paper's
-- lock lies in a plane; so does this one.
local head = coif.head { style = "cartoon" }

-- The lock leaves the back of the head at an angle over the level, and turns by another on its way to the tip.
local function lock(from, turn)
  local root, step = head:point { azimuth = 180, elevation = 35 }, 1.5
  local points, at = { root }, root
  for i = 1, 19 do
    local angle = math.rad(from + turn * (i / 19) ^ 1.3)
    at += step * vector.create(0, math.sin(angle), -math.cos(angle))
    table.insert(points, at)
  end
  return coif.tuft {
    stroke = points, sides = 40, ellipse = { horizontal = 2.6, vertical = 1.9 }, plane = { 1, 0, 0 }, bury = true,
    material = "#5b3a8c",
  }
end
local rest, up, under = lock(25, -95), lock(60, 25), lock(5, -190)
assert(rest:stats().triangles == 1520)

local moving = coif.animate {
  states = { rest, up, under },
  path   = coif.path { states = { 2, 1, 3 }, frames = 40, ease = "smooth" },
}
assert(moving.frames == 40)
return coif.scene {
  head, moving, shading = "toon", views = { "left" }, strip = { 5, 10, 15, 20, 25, 30, 35, 40 },
}
