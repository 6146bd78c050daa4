local head = coif.head()
local function lock(azimuth, ellipse)
  return coif.tuft {
    stroke = { { azimuth = azimuth, elevation = 40 }, { azimuth = azimuth, elevation = 20, height = 4 } }, ellipse = ellipse,
  }
end
local between = coif.fill { lock(60), lock(180, { horizontal = 2, vertical = 1 }), around = 60 }
return coif.scene { head, between }
