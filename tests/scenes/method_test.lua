-- Small scenes for single laws of the method.

local function scene(hair, head)
  return coif.scene { head, hair }
end

coif.test("a strand without domains goes straight out of the skin", function(t)
  local head = coif.head()
  local hair = head:scalp():guides { count = 60, length = 5, length_variation = 0, step = 0.5 }:grow {}
  local figures = t:scene(scene(hair, head)).hair:stats()
  t:equal(figures.strands, 60)
  t:near(figures.longest, 5, 0.01)
  t:near(figures.shortest, 5, 0.01)
  t:equal(figures.inside, 0)
end)

coif.test("a lower density is a subset, and covers less", function(t)
  local head = coif.head()
  local down = coif.queue { coif.domain.directional { box = head:box("all"), direction = coif.down } }
  local guides = head:scalp():guides { count = 100, length = 6, step = 0.5 }:grow { global = down }
  local many = t:scene(scene(guides:fill { strands = 2000 }, head)).hair
  local few = t:scene(scene(guides:fill { strands = 200 }, head)).hair
  t:require(t:greater(many:stats().coverage, few:stats().coverage))
  t:less(few:coverage(0.2), few:coverage(0.5))
  t:near(many:coverage(30), 1, 0.0001)
end)

coif.test("a gather domain brings every strand to its core", function(t)
  local head = coif.head()
  local core = head:at("occiput", { 0, 2, -4 })
  local queue = coif.queue { coif.domain.gather { core = core, core_radius = 1 } }
  local hair = head:scalp():guides { count = 80, length = 200, step = 0.5 }:grow { global = queue }
  local figures = t:scene(scene(hair, head)).hair:stats()
  t:equal(figures.inside, 0)
  -- They end at the core, so none is as long as it might be.
  t:less(figures.longest, 60)
end)

coif.test("mistakes in a style are answered", function(t)
  t:error(function() return t:run "../../examples/ponytail.lua" { lenght = 60, strands = 1000 }.hair end, "did you mean `length`?")
  t:error(function() return t:run "../../examples/ponytail.lua" { length = 1000 }.hair end, "out of range")
  t:error(function() return t:run "../../examples/ponitail.lua" end, "did you mean `ponytail.lua`?")
  t:error(function() return t:run "../../../../etc/passwd" end, "outside")
end)
