-- Figure 10 of Shimosoyama, Yamamoto, Noma 2015: the two tufts that figure 11 fills between.
-- The paper's: two tufts with the same number of control points (its section 4). The paper prints no numbers with this
-- figure; chosen here: the strokes, and d, p = 60, 40 and 36, 30.
local head = coif.head { style = "cartoon" }
local function tuft(azimuth, d, p)
  return coif.tuft {
    stroke = {
      { azimuth = azimuth, elevation = 42 }, { azimuth = azimuth, elevation = 40, height = 4 },
      { azimuth = azimuth, elevation = 20, height = 7 }, { azimuth = azimuth, elevation = -8, height = 6 },
    },
    diameter = d, peak = p,
  }
end
return coif.scene {
  head, tuft(50, 60, 40), tuft(-50, 36, 30), shading = "toon", views = { "front", "left", "back", "right" },
}
