local head = coif.head()
local spike = coif.tuft {
  stroke = { { azimuth = 0, elevation = 90, hight = 2 }, head:point { elevation = 90, height = 8 } },
  diameter = 120, peak = 0, colour = "#f00",
}
return coif.scene { head, spike }
