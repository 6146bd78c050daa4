-- Locks that move by their posed states: figures 5 and 6 of Ren, Zhao, Geng 2010, and laws that a script sees.

-- How far two corners of bounding boxes are apart.
local function apart(a, b)
  return math.max(vector.magnitude(a.min - b.min), vector.magnitude(a.max - b.max))
end

coif.test("figures 5 and 6", function(t)
  local scene = t:run("meshik_figures_5_6.lua", {})
  t:equal(scene.tufts:stats().triangles, 1520)
  -- Up at first, then at rest, then under the head's height.
  local first, last = scene:at(1).tufts:stats(), scene:at(40).tufts:stats()
  t:greater(first.max.y, last.max.y + 5)
  t:less(last.min.y, first.min.y - 5)
  for _, frame in { 1, 20, 40 } do
    t:preview(scene, "meshik_figure_6_" .. frame, { frame = frame, size = 120, views = { "left" } })
  end
end)

-- A lock that hangs from the back of the head and bends to the head's left.
local function lock(head, bend)
  local root = head:point { azimuth = 180, elevation = 20 }
  local points, at = { root }, root
  for i = 1, 10 do
    local angle = math.rad(bend * i / 10)
    at += 1.6 * vector.create(math.sin(angle), -math.cos(angle), -0.3)
    table.insert(points, at)
  end
  return coif.tuft { stroke = points, sides = 16, up = { 0, 0, -1 }, diameter = 30, bury = true }
end

coif.test("states are met, and a loop closes", function(t)
  local head = coif.head { style = "cartoon" }
  local rest, left, right = lock(head, 0), lock(head, 60), lock(head, -60)
  local moving = coif.animate {
    states = { rest, left, right }, loop = true, path = coif.path { states = { 1, 2, 1, 3 }, closed = true, frames = 40 },
  }
  t:equal(moving.frames, 40)
  t:equal(moving.loops, true)
  local scene = t:scene(coif.scene { moving }, 1)
  local function at(frame) return t:scene(coif.scene { moving }, frame):stats() end
  t:less(apart(at(1), t:scene(coif.scene { rest }):stats()), 0.05)
  t:less(apart(at(11), t:scene(coif.scene { left }):stats()), 0.3)
  t:less(apart(at(41), at(1)), 1e-4)
  t:ok(scene ~= nil)
end)

coif.test("a lock on a head that turns trails behind it", function(t)
  local head = coif.head { style = "cartoon" }
  local turn = head:motion { { time = 0 }, { time = 0.3, yaw = 60, ease = "linear" }, { time = 1 } }
  local function clip(lag)
    return coif.animate {
      states = { lock(head, 0), lock(head, 45), lock(head, -45) }, motion = turn,
      path = not lag and coif.path { offsets = { { 0, 0, 0 }, { 0, 0, 0 } }, frames = turn.frames } or nil,
      lag = lag,
    }
  end
  local rigid, trailing = clip(nil), clip { hold = 6 }
  t:equal(trailing.frames, turn.frames)
  -- The head turns to its left, so the back of the head goes to its right: the tip stays behind, to the left.
  local function at(what, frame) return t:scene(coif.scene { what }, frame):stats() end
  t:less(apart(at(rigid, 1), at(trailing, 1)), 0.01)
  t:greater(apart(at(rigid, 8), at(trailing, 8)), 0.5)
end)

coif.test("mistakes are told", function(t)
  local head = coif.head { style = "cartoon" }
  local rest, left = lock(head, 0), lock(head, 60)
  local sway = coif.path { states = { 1, 2 }, frames = 5 }
  t:error(function() return coif.animate { states = { rest }, path = sway } end, "no state besides the rest")
  t:error(function() return coif.animate { states = { rest, left }, path = sway, loop = true } end, "ends where it began")
  t:error(function() return coif.animate { states = { rest, left } } end, "nothing moves")
  t:error(function() return coif.animate { states = { rest, left }, path = sway, lag = {} } end, "nothing to lag behind")
  t:error(function() return coif.path { frames = 3 } end, "without points")
  t:error(function()
    return coif.animate { states = { rest, left }, path = sway, handles = { { path = sway } } }
  end, "both move vertex")
end)
