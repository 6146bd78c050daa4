-- Every example, thinned out: nothing inside the head, and a golden picture.

local examples = {
  bob           = "three-quarter",
  braid         = "back",
  caged         = "front",
  crop          = "three-quarter",
  lifted        = "front",
  long_straight = "front",
  pigtails      = "front",
  ponytail      = "left",
  ponytail_edit = "front",
  ringlets      = "front",
  three_heads   = "three-quarter",
  top_knot      = "left",
  waves         = "three-quarter",
}

local names = {}
for name in pairs(examples) do
  table.insert(names, name)
end
table.sort(names)

for _, name in ipairs(names) do
  coif.test(name, function(t)
    local scene = t:run("../../examples/" .. name .. ".lua", { strands = 3000 })
    t:equal(scene:stats().inside, 0)
    t:preview(scene, name, { views = { examples[name] }, size = 160 })
  end)
end
