-- Figure 5 of the method's paper in its two states: a ponytail, and after the quick edit two bunches.

local few = { strands = 1500, length = 45 }

-- How far a part reaches to the head's left and right.
local function reach(part)
  local figures = part:stats()
  return figures.max.x, -figures.min.x
end

coif.test("a, b: one tail behind the head", function(t)
  local scene = t:run "../../examples/ponytail.lua" (few)
  local hair = scene.hair:stats()
  t:equal(hair.strands, 1500)
  t:equal(hair.inside, 0)
  t:equal(hair.guides, 800)
  -- The length and its variation of a quarter; the curl makes strands longer than the axis they run around.
  t:between(hair.longest, 40, 62)
  t:between(hair.mean_length, 30, 50)
  -- Drawn tight, the hair lies all over the scalp.
  t:greater(hair.coverage, 0.9)
  -- The tail hangs behind, far below the head, and is alike on both sides.
  t:less(hair.min.z, scene.head:stats().min.z)
  t:less(hair.min.y, -20)
  t:less(hair.symmetry, 1.0)
  local left, right = reach(scene.hair)
  t:near(left, right, 3)
end)

coif.test("c, d: two bunches beside the head", function(t)
  local tail = t:run "../../examples/ponytail.lua" (few)
  local bunches = t:run "../../examples/ponytail_edit.lua" (few)
  local hair = bunches.hair:stats()
  t:equal(hair.inside, 0)
  t:greater(hair.coverage, 0.9)
  t:less(hair.symmetry, 1.5)
  -- The edit moves the ties apart: the hair reaches farther out on either side, by much.
  local left, right = reach(bunches.hair)
  local before = reach(tail.hair)
  t:greater(left, before + 3)
  t:near(left, right, 4)
end)

coif.test("the natural domain leaves the axis where it is", function(t)
  -- Longer hair only goes on: more of it, not another style.
  local short = t:run "../../examples/ponytail.lua" { strands = 1000, length = 30 }
  local long = t:run "../../examples/ponytail.lua" { strands = 1000, length = 60 }
  t:less(short.hair:stats().mean_length, long.hair:stats().mean_length - 20)
  t:less(long.hair:stats().min.y, short.hair:stats().min.y)
  t:near(short.hair:stats().max, long.hair:stats().max, 3)
end)
