-- Figure 9 of Shimosoyama, Yamamoto, Noma 2015: several strokes, each with several parameters d and p.
-- The paper's: that a tuft follows its stroke and that d and p change it. The paper prints no numbers with this figure;
-- chosen here: the four strokes (straight, an arc, a wave, a hook) and d, p = 20, 20; 45, 50; 70, 80.
local head = coif.head { style = "cartoon" }

local strokes = {
  { { 40, 0 }, { 40, 6 }, { 40, 12 }, { 40, 18 } },
  { { 40, 0 }, { 46, 6 }, { 40, 12 }, { 26, 16 } },
  { { 40, 0 }, { 50, 5 }, { 32, 10 }, { 44, 17 } },
  { { 40, 0 }, { 46, 8 }, { 30, 13 }, { 12, 8 } },
}
local all = nil ---@type any
for i, shape in strokes do
  for k, look in { { 20, 20 }, { 45, 50 }, { 70, 80 } } do
    local azimuth, stroke = 90 * (i - 1) + 28 * (k - 2), {}
    for _, p in shape do
      table.insert(stroke, { azimuth = azimuth, elevation = p[1], height = p[2] > 0 and p[2] or nil })
    end
    local one = coif.tuft { stroke = stroke, diameter = look[1], peak = look[2], bury = true }
    all = all and all + one or one
  end
end
assert(all.count == 12)
return coif.scene { head, all, shading = "toon", views = { "front", "left", "back", "right" } }
