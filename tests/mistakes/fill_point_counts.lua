local head = coif.head()
local a = coif.tuft { stroke = { { azimuth = 60, elevation = 40 }, { azimuth = 60, elevation = 20, height = 4 } } }
local b = coif.tuft {
  stroke = { { azimuth = 180, elevation = 40 }, { azimuth = 180, elevation = 30, height = 3 }, { azimuth = 180, elevation = 10, height = 4 } },
}
local between = coif.fill { a, b, around = 60 }
return coif.scene { head, between }
