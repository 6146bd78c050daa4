-- Every moving example: what holds from frame to frame, and golden pictures of two frames.

local views = {
  look_around = "front",
  sway        = "back",
}

coif.test("look_around", function(t)
  local scene = t:run("../../examples/moving/look_around.lua", {})
  local first, left = scene:at(1), scene:at(14)
  t:equal(first:stats().triangles, left:stats().triangles)
  -- The locks go with the head: they are as wide as before, and elsewhere.
  t:ok(first.tufts:stats().max ~= left.tufts:stats().max)
  -- A loop begins anew.
  t:near(scene:at(73).tufts:stats().max, first.tufts:stats().max, 1e-4)
  t:preview(scene, "moving_look_around", { frame = 14, size = 120, views = { views.look_around } })
  t:preview(scene, "moving_look_around_nod", { frame = 60, size = 120, views = { views.look_around } })
end)

coif.test("sway", function(t)
  local scene = t:run("../../examples/moving/sway.lua", { strands = 700 })
  local first, last = scene:at(1).hair:stats(), scene:at(19).hair:stats()
  t:equal(first.strands, last.strands)
  t:near(first.mean_length, last.mean_length, 0.02 * first.mean_length)
  for frame = 1, 36, 17 do
    t:less(scene:at(frame):stats().inside, 15)
  end
  -- From one side to the other.
  t:greater(first.max.x, last.max.x)
  t:less(last.min.x, first.min.x)
  t:preview(scene, "moving_sway", { frame = 1, size = 120, views = { views.sway } })
  t:preview(scene, "moving_sway_middle", { frame = 10, size = 120, views = { views.sway } })
end)

coif.test("clips", function(t)
  local head = coif.head()
  local guides = head:scalp():guides { count = 20, length = 12 }
  local function groom(x)
    return guides:grow { global = coif.queue {
      coif.domain.directional { box = head:box("all"), direction = { x, -1, 0 }, strength = 0.5 },
    } }
  end
  local clip = coif.clip { groom(-1), groom(1), seconds = 0.5, rate = 10 }
  t:equal(clip.frames, 6)
  t:near(clip.seconds, 0.5, 1e-6)
  t:equal(clip.loops, false)
  local figures = clip:stats()
  t:greater(figures.travel, 3)
  t:less(figures.stretch, 0.05)
  t:equal(clip:frame(1):stats().mean_length, groom(-1):stats().mean_length)
  local filled = clip:natural { coif.domain.wave { box = head:box("all"), period = 4, radius = 0.3 } }:fill { strands = 50 }
  t:equal(filled.frames, 6)
  t:equal(filled:stats().guides, 20)
  -- At rest in the middle, frames of a scene, a head that moves besides.
  local turn = head:motion { { time = 0 }, { time = 1, yaw = 90 }, rate = 10 }
  t:near(turn:place({ 0, -3, 8.5 }, 11), { 10, -3, -1.5 }, 1)
  local scene = coif.scene { head, filled, motion = turn }
  t:equal(t:scene(scene, 1).hair:stats().strands, 50)
  t:less(t:scene(scene, 11):stats().inside, 3)
  t:error(function() return coif.scene { head, filled, motion = head:motion { { time = 0 }, { time = 1 } } } end, "frames in a second")
end)

-- Locks that move by their posed states: the frames that are pictures.
local locks = {
  bun_and_tail = { 1, 14 },
  many_locks   = { 1, 13 },
  one_lock     = { 1, 10 },
  sixty_locks  = { 1, 16 },
}
local names = {}
for name in pairs(locks) do
  table.insert(names, name)
end
table.sort(names)
for _, name in ipairs(names) do
  coif.test(name, function(t)
    local scene = t:run("../../examples/moving/" .. name .. ".lua", {})
    local function apart(a, b)
      return math.max(vector.magnitude(a.min - b.min), vector.magnitude(a.max - b.max))
    end
    local one, other = scene:at(locks[name][1]):stats(), scene:at(locks[name][2]):stats()
    t:equal(one.triangles, other.triangles)
    if name == "sixty_locks" then t:equal(one.tufts, 69) end
    t:greater(apart(one, other), 0.5)
    for _, frame in locks[name] do
      t:preview(scene, "moving_" .. name .. "_" .. frame, { frame = frame, size = 120, views = { "back" } })
    end
  end)
end
