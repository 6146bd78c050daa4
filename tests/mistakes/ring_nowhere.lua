local head = coif.head()
local lock = coif.tuft { stroke = { { azimuth = 0, elevation = 90 }, { azimuth = 0, elevation = 90, height = 8 } } }
return coif.scene { head, lock, coif.ring { lock, at = 1 } }
