local head = coif.head()
local spike = coif.tuft {
  stroke = { { azimuth = 0, elevation = 90, height = 2 }, { azimuth = 0, elevation = 90, height = 8 } },
}
return coif.scene { head, spike, views = { "front" } }
