-- Every example of hair under forces: what must hold, and golden pictures.

local few = {
  wind          = { strands = 400 },
  bundle        = { strands = 800, guides = 60 },
  vortex        = { strands = 800, guides = 60 },
  fluffed       = { strands = 800, guides = 80 },
  ponytail_wind = { strands = 500 },
  turn          = { strands = 500 },
}

local function example(name)
  return "../../examples/dynamics/" .. name .. ".lua"
end

local function with(name, more)
  local all = {}
  for key, value in few[name] do all[key] = value end
  for key, value in more do all[key] = value end
  return all
end

coif.test("wind blows hair to where it blows", function(t)
  local blown = t:run(example "wind") (few.wind).hair:stats()
  local calm = t:run(example "wind") (with("wind", { wind = 0 })).hair:stats()
  t:equal(blown.inside, 0)
  t:greater(blown.max.x, calm.max.x + 2)
  t:less(blown.min.z, calm.min.z)
  t:preview(t:run(example "wind") (few.wind), "dynamics_wind", { size = 120, views = { "front", "left" } })
end)

coif.test("an attractor ties a bundle", function(t)
  local scene = t:run(example "bundle") (few.bundle)
  t:equal(scene.hair:stats().inside, 0)
  t:preview(scene, "dynamics_bundle", { size = 120, views = { "left", "back" } })
end)

coif.test("a vortex rolls hair up", function(t)
  local rolled = t:run(example "vortex") (few.vortex)
  local straight = t:run(example "vortex") (with("vortex", { turn = 0 }))
  t:equal(rolled.hair:stats().inside, 0)
  t:ok(rolled.hair:stats().min ~= straight.hair:stats().min)
  t:preview(rolled, "dynamics_vortex", { size = 120, views = { "front", "back" } })
end)

coif.test("a repeller fluffs a flat style", function(t)
  local fluffy = t:run(example "fluffed") (few.fluffed)
  local flat = t:run(example "fluffed") (with("fluffed", { fluff = 0 }))
  t:equal(fluffy.hair:stats().inside, 0)
  t:greater(fluffy.hair:stats().max.y, flat.hair:stats().max.y)
  t:preview(fluffy, "dynamics_fluffed", { size = 120, views = { "front", "left" } })
end)

coif.test("a ponytail in the wind", function(t)
  local scene = t:run(example "ponytail_wind") (few.ponytail_wind)
  local first, last = scene:at(1).hair:stats(), scene:at(25).hair:stats()
  t:near(first.mean_length, last.mean_length, 0.05 * first.mean_length)
  t:greater(last.max.x, first.max.x)
  t:preview(scene, "dynamics_ponytail_wind", { frame = 13, size = 120, views = { "back" } })
end)

coif.test("hair lags behind a head that turns and stops", function(t)
  local scene = t:run(example "turn") (few.turn)
  local first, last = scene:at(1).hair:stats(), scene:at(25).hair:stats()
  t:near(first.mean_length, last.mean_length, 0.05 * first.mean_length)
  t:preview(scene, "dynamics_turn", { frame = 8, size = 120, views = { "back" } })
end)
