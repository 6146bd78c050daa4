local head = coif.head()
local function whisker(azimuth)
  return coif.tuft { stroke = { { azimuth = azimuth, elevation = -30 }, { azimuth = azimuth, elevation = -40, height = 3 } } }
end
local beard = coif.fill { whisker(20), whisker(60), around = 60 }
return coif.scene { head, beard }
