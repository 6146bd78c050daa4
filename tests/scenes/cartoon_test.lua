-- Every cartoon example: locks of hair on the head, and a golden picture.

local examples = {
  bob           = "three-quarter",
  long_straight = "front",
  spiky_hero    = "front",
  swept_back    = "three-quarter",
  top_bun       = "left",
  twin_tails    = "front",
}

local names = {}
for name in pairs(examples) do
  table.insert(names, name)
end
table.sort(names)

for _, name in ipairs(names) do
  coif.test(name, function(t)
    local scene = t:run("../../examples/cartoon/" .. name .. ".lua", {})
    local all, head = scene:stats(), scene.head:stats()
    t:greater(all.tufts, 0)
    t:greater(all.triangles, head.triangles)
    -- Hair stands out over the head.
    t:greater(all.max.y, head.max.y)
    t:preview(scene, "cartoon_" .. name, { views = { examples[name] }, size = 160 })
  end)
end
