-- long_straight.lua: long straight hair with a blunt fringe and straight side locks, cut to one length.
local p = coif.params {
  length = { 30, min = 14, max = 50, unit = "cm", doc = "length below the ears" },
  hair   = { "#2c2f4a", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, light = "#8fa3e0", shine = 0.7 }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

-- Blunt: as wide at its end as above it.
local blunt = { { 0, 0.8, 0.7 }, { 0.25, 4.4, 1.4 }, { 0.6, 5.2, 1.4 }, { 0.985, 4.8, 1.1 }, { 1, 4.2, 0.5 } }

local function fall(azimuth, length)
  local over = at(azimuth, 8, 2.0)
  local ear  = at(azimuth, -16, 0)
  local out  = vector.create(over.x, 0, over.z) / math.sqrt(over.x ^ 2 + over.z ^ 2)
  local below = vector.create(over.x, ear.y - 2, over.z) - 1.3 * out
  return coif.tuft {
    stroke = {
      at(azimuth, 76), at(azimuth, 54, 1.3), at(azimuth, 32, 1.8), over, below,
      below - vector.create(0, 0.5 * length, 0) + 0.2 * out, below - vector.create(0, length, 0) + 0.4 * out,
    },
    profile = blunt, bend = 50, material = look, lift = true,
  }
end

local left  = fall(74, p.length - 9)
local back  = fall(180, p.length - 9)
local curtain = coif.fill { left, back, left:mirrored(), around = 52, everywhere = true, lift = true }

-- The fringe: cut straight over the brows.
local front = {}
for i = -4, 4 do
  local azimuth = 12.5 * i
  table.insert(front, coif.tuft {
    stroke = {
      at(azimuth, 76), at(azimuth, 58, 1.6), at(azimuth, 38, 2.0), at(azimuth, 20, 1.5), at(azimuth, 6, 1.1),
    },
    profile = { { 0, 0.8, 0.7 }, { 0.35, 3.0, 1.2 }, { 0.98, 3.1, 0.9 }, { 1, 2.9, 0.4 } },
    bend = 30, material = look, lift = true,
  })
end

-- The cap ends under the fringe and the side locks, so that its border is nowhere to be seen.
local border = {}
for _, place in { { 0, 30 }, { 36, 28 }, { 62, 20 }, { 84, 10 }, { 108, -14 }, { 140, -34 }, { 180, -40 } } do
  table.insert(border, at(place[1], place[2]))
end
for i = 6, 2, -1 do table.insert(border, vector.create(-border[i].x, border[i].y, border[i].z)) end

-- Side locks before the ears, cut at the jaw.
local side = coif.tuft {
  stroke = { at(62, 66), at(61, 46, 1.5), at(60, 26, 1.9), at(59, 4, 1.7), at(57, -22, 1.9), at(54, -44, 2.4) },
  profile = { { 0, 0.8, 0.6 }, { 0.3, 3.2, 1.2 }, { 0.97, 3.0, 1.0 }, { 1, 2.8, 0.5 } },
  bend = 40, material = look, lift = true,
}

return coif.scene {
  head, coif.cap { border = border, thickness = 0.9, material = look }, curtain, front, side, side:mirrored(),
  shading = "toon", skin = "#f8dcc8", views = { "front", "three-quarter", "left", "back" },
}
