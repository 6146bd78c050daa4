local head = coif.head()
local lock = coif.tuft {
  stroke = { head:point { azimuth = 90, elevation = 50 }, head:point { azimuth = 90, elevation = 45, height = 2 },
             head:point { azimuth = -90, elevation = 45, height = 2 } },
}
return coif.scene { head, lock, views = { "front" } }
