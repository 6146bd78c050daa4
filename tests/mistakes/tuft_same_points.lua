local head = coif.head()
local up = { azimuth = 0, elevation = 60, height = 3 }
local spike = coif.tuft { stroke = { { azimuth = 0, elevation = 60 }, up, up, { azimuth = 0, elevation = 60, height = 6 } } }
return coif.scene { head, spike }
