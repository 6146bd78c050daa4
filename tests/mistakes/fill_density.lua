local head = coif.head()
local a = coif.tuft { stroke = { { azimuth = 60, elevation = 40 }, { azimuth = 60, elevation = 20, height = 4 } } }
local all = coif.fill { a, a:mirrored(), around = 0, up = 101, down = -5, jitter = 2 }
return coif.scene { head, all }
