-- NAME_test.lua: what must stay true of NAME.lua.
--   coif test .             runs it
--   coif test . --accept    keeps its picture as golden/NAME.png, which the next runs are compared with

coif.test("NAME grows on the head and stays out of it", function(t)
  local scene = t:run "NAME.lua" { strands = 2000 }
  local hair = scene.hair:stats()
  t:equal(hair.inside, 0)
  t:preview(scene, "NAME")
end)
