-- Figure 10 of Shimosoyama, Yamamoto, Noma 2015: the two tufts that figure 11 fills between.
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
