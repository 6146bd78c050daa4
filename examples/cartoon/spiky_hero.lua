-- spiky_hero.lua: short spikes all over the head, swept up and back from the brow.
local p = coif.params {
  length = { 1, min = 0.5, max = 2, doc = "length of the spikes, as a factor" },
  hair   = { "#f2b632", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, shine = 0.4 }

-- A spike grows at (azimuth, elevation), rises, and ends over another place.
local function spike(azimuth, elevation, to_azimuth, to_elevation, height, width)
  local function at(t, h)
    return head:point {
      azimuth = azimuth + (to_azimuth - azimuth) * t, elevation = elevation + (to_elevation - elevation) * t, height = h,
    }
  end
  local h = height * p.length
  return coif.tuft {
    stroke = { at(0, 0), at(0.22, 0.30 * h), at(0.55, 0.66 * h), at(1, h) },
    profile = { { 0, 0.8 * width, 0.5 * width }, { 0.3, width, 0.62 * width }, { 0.7, 0.55 * width, 0.36 * width }, { 1, 0, 0 } },
    material = look, bury = true,
  }
end

local spikes = {}
local function ring(list)
  for _, s in list do
    local one = spike(s[1], s[2], s[3], s[4], s[5], s[6])
    table.insert(spikes, one)
    if s[1] ~= 0 and s[1] ~= 180 then table.insert(spikes, one:mirrored()) end
  end
end

-- The brow: locks that fall onto the forehead.
ring {
  { 5, 52, -9, 16, 1.8, 4.2 }, { 22, 50, 27, 12, 2.2, 4.4 }, { 42, 47, 52, 10, 2.4, 4.4 }, { 60, 42, 72, 6, 2.4, 4.2 },
}
-- Over the brow: up and outward.
ring {
  { 0, 62, 14, 58, 7.5, 4.6 }, { 24, 60, 34, 44, 7.5, 4.8 }, { 50, 55, 60, 40, 7.5, 4.8 }, { 72, 44, 80, 26, 6.5, 4.6 },
}
-- The crown.
ring {
  { 0, 78, 6, 74, 9, 5 }, { 45, 74, 50, 60, 9, 5 }, { 92, 66, 92, 48, 8.5, 5 }, { 135, 72, 138, 54, 8.5, 5 }, { 180, 72, 172, 52, 8.5, 5 },
}
-- Sides and back.
ring {
  { 84, 28, 88, 6, 4.6, 4.2 }, { 100, 44, 106, 22, 6, 4.6 }, { 125, 48, 130, 28, 6.5, 4.8 }, { 152, 48, 154, 28, 6.5, 4.8 },
  { 180, 50, 180, 30, 6.5, 4.8 }, { 108, 22, 112, 0, 4.6, 4.4 }, { 134, 24, 136, 2, 5, 4.6 }, { 160, 24, 160, 0, 5, 4.6 },
  { 116, 2, 120, -20, 3.4, 4 }, { 142, 2, 142, -22, 3.6, 4.4 }, { 168, 2, 168, -24, 3.6, 4.4 },
}

return coif.scene {
  head, coif.cap { thickness = 0.8, material = look }, spikes,
  shading = "toon", skin = "#f3cfb4", views = { "front", "three-quarter", "left", "back" },
}
