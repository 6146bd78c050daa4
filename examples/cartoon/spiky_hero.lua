-- spiky_hero.lua: short spikes all over the head, swept up and back from the brow.
local p = coif.params {
  length = { 1, min = 0.5, max = 2, doc = "length of the spikes, as a factor" },
  hair   = { "#f2b632", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, shine = 0.4 }

-- A spike grows at (azimuth, elevation), lies on the hair at first, and rises to a tip over another place.
local function spike(azimuth, elevation, to_azimuth, to_elevation, height, width)
  local function at(t, h)
    return head:point {
      azimuth = azimuth + (to_azimuth - azimuth) * t, elevation = elevation + (to_elevation - elevation) * t, height = h,
    }
  end
  local h = height * p.length
  return coif.tuft {
    stroke = { at(0, 0), at(0.25, 0.6 + 0.10 * h), at(0.58, 0.7 + 0.34 * h), at(1, h) },
    profile = {
      { 0, 0.4, 0.4 }, { 0.15, 0.8 * width, 0.45 * width }, { 0.32, width, 0.6 * width },
      { 0.65, 0.55 * width, 0.42 * width }, { 1, 0, 0 },
    },
    material = look, bury = true,
  }
end

local spikes = {}
local function add(list)
  for _, s in list do
    local one = spike(s[1], s[2], s[3], s[4], s[5], s[6])
    table.insert(spikes, one)
    if s.lone == nil then table.insert(spikes, one:mirrored()) end
  end
end

-- The brow: locks that fall onto the forehead, one of them across it.
add {
  { 6, 68, -13, 4, 1.5, 5.0, lone = true }, { -12, 66, -32, -2, 1.7, 4.8, lone = true },
  { 22, 67, 13, 10, 1.6, 4.6, lone = true }, { 32, 64, 38, -1, 1.9, 5.0, lone = true },
  { -32, 62, -50, -4, 2.0, 4.8, lone = true }, { 48, 58, 58, -6, 2.0, 5.0, lone = true },
  { 62, 48, 72, -24, 2.0, 4.2 },
}
-- Over the brow: up and outward.
add {
  { 10, 80, 14, 62, 11, 6, lone = true }, { -16, 78, -24, 58, 10, 6, lone = true }, { 40, 74, 44, 50, 10, 6 },
  { 62, 68, 66, 38, 9.4, 6 }, { 82, 58, 82, 24, 8, 5.8 }, { 94, 44, 90, 8, 6.2, 5.4 },
}
-- The crown and the back: backward, the lower the flatter.
add {
  { 180, 84, 176, 62, 11, 6.4, lone = true }, { 120, 78, 116, 54, 10.5, 6.2 }, { 152, 68, 154, 44, 10, 6.4 },
  { 112, 60, 106, 30, 9, 6.2 }, { 136, 54, 134, 24, 8.8, 6.2 }, { 174, 56, 172, 26, 8.8, 6.4 }, { 158, 40, 156, 8, 7.6, 6.2 },
  { 112, 38, 108, 2, 6.4, 5.8 }, { 134, 30, 132, -6, 6.2, 5.8 }, { 172, 26, 174, -12, 6, 5.8 }, { 104, 18, 108, -18, 3.8, 4.8 },
  { 126, 10, 128, -30, 3.8, 5.2 }, { 152, 14, 150, -28, 4.6, 5.6 }, { 180, 2, 180, -42, 3.6, 5.4, lone = true }, { 160, -4, 158, -44, 3, 5 },
}

return coif.scene {
  head, coif.cap { thickness = 0.8, material = look }, spikes,
  shading = "toon", skin = "#f3cfb4", views = { "front", "three-quarter", "left", "back" },
}
