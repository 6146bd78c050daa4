-- spiky_hero.lua: short spikes all over the head, swept up and back from the brow.
local p = coif.params {
  length = { 1, min = 0.5, max = 2, doc = "length of the spikes, as a factor" },
  hair   = { "#f2b632", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, shine = 0.4, tones = 3 }

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
-- A spike and its fellow on the other side, which is never quite its mirror image: turned and drawn out a little.
local function add(list)
  for i, s in list do
    table.insert(spikes, spike(s[1], s[2], s[3], s[4], s[5], s[6]))
    if s.lone == nil then
      local turn, grow = 5 * math.sin(7 * i), 1 + 0.16 * math.sin(3 * i + 1)
      table.insert(spikes, spike(0.6 * turn - s[1], s[2] + 2, turn - s[3], s[4] + 1.4 * turn, grow * s[5], s[6]))
    end
  end
end

-- The brow: locks that fall onto the forehead from a parting over the left eye, one of them across it.
add {
  { 10, 69, -16, 1, 1.6, 5.0, lone = true }, { -14, 66, -37, -4, 1.8, 4.8, lone = true },
  { 22, 68, 4, 11, 1.5, 3.6, lone = true }, { 30, 66, 30, 2, 2.0, 4.8, lone = true },
  { -34, 61, -55, -7, 2.1, 4.6, lone = true }, { 46, 60, 56, -5, 2.2, 5.2, lone = true },
  { 62, 48, 72, -24, 2.2, 4.2 },
}
-- Over the brow: up, and all of them leaning to the head's right as if the wind stood there.
add {
  { 14, 80, -8, 66, 12.5, 6.4, lone = true }, { -20, 77, -44, 58, 10.5, 6, lone = true },
  { 44, 75, 34, 54, 11, 5.6, lone = true }, { -52, 70, -70, 44, 9, 5.4, lone = true },
  { 64, 66, 66, 40, 9.6, 6, lone = true }, { 84, 57, 86, 25, 8, 5.6 }, { 96, 43, 94, 8, 6.4, 5.2 },
}
-- The crown: long spikes that lean back, one beside the other.
add {
  { 150, 86, 196, 58, 12, 6.6, lone = true }, { 118, 78, 128, 50, 11.4, 6.0, lone = true },
  { -116, 79, -102, 56, 9.6, 6.0, lone = true }, { 160, 70, 172, 40, 10.4, 6.0, lone = true },
  { -154, 68, -140, 38, 11, 6.4, lone = true },
}
-- The back: the lower the flatter, in three staggered rows.
add {
  { 110, 58, 108, 27, 9.2, 6.0 }, { 138, 52, 142, 20, 8.4, 5.6 }, { 172, 50, 186, 18, 9.6, 6.2, lone = true },
  { 122, 34, 118, -2, 6.6, 5.6 }, { 152, 30, 158, -8, 7.2, 5.8 }, { 182, 26, 176, -14, 6.2, 5.4, lone = true },
  { 106, 16, 110, -20, 3.8, 4.6 }, { 134, 10, 138, -30, 4.4, 5.2 }, { 164, 6, 170, -36, 4.6, 5.2 },
  { 150, -6, 146, -44, 3, 4.4 }, { 180, -8, 188, -50, 3.2, 4.6, lone = true },
}

return coif.scene {
  head, coif.cap { thickness = 0.8, material = look }, spikes,
  shading = "toon", skin = "#f3cfb4", views = { "front", "three-quarter", "left", "back" },
}
