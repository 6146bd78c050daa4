-- Garments: every example with a golden picture; girths to a tenth of a millimetre; nothing in the body.

local examples = {
  held_back = "left",
  waist     = "front",
  wardrobe  = "front",
}

local names = {}
for name in pairs(examples) do
  table.insert(names, name)
end
table.sort(names)

for _, name in ipairs(names) do
  coif.test(name, function(t)
    local scene = t:run("../../examples/garments/" .. name .. ".lua", {})
    t:preview(scene, "garments_" .. name, { views = { examples[name] }, size = 200 })
  end)
end

coif.test("a waist of 57 cm becomes 67 cm, and a bust 88.7 cm", function(t)
  local dress = coif.garment.dress { waist = 57, bust = 84 }
  t:near(dress:girth { tape = "waist" }, 57, 0.1)
  local after = dress:fit { waist = 67, bust = 88.7 }
  t:near(after:girth { tape = "waist" }, 67, 0.01)
  t:near(after:girth { tape = "bust" }, 88.7, 0.01)
  t:near(after:girth { tape = "hip" }, dress:girth { tape = "hip" }, 0.01)
end)

coif.test("the back stays while the bust is let out", function(t)
  local shirt = coif.garment.shirt {}
  local after = shirt:fit { bust = 94, hold = "back" }
  t:near(after:girth { tape = "bust" }, 94, 0.01)
  t:near(after:stats().min.z, shirt:stats().min.z, 0.6)
end)
