-- bob.lua: a bob to the jaw with a full fringe; both are filled between a few locks by hand.
local p = coif.params {
  length = { 1, min = 0.7, max = 1.8, doc = "length of the bob, as a factor" },
  hair   = { "#7b3f8c", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, shine = 0.7 }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

-- A lock of the bob: from beside the parting over the skull, then down, turned in at the end.
local function lock(azimuth, fall)
  local over = at(azimuth, 4, 2.6)
  local way  = vector.create(over.x, 0, over.z) / math.sqrt(over.x ^ 2 + over.z ^ 2)
  fall = fall * p.length
  return coif.tuft {
    stroke = {
      at(azimuth, 74, 0), at(azimuth, 52, 1.7), at(azimuth, 28, 2.4), over,
      over + 0.35 * way - vector.create(0, 0.55 * fall, 0), over - 2.2 * way - vector.create(0, fall, 0),
    },
    profile = { { 0, 1, 0.8 }, { 0.3, 4.6, 1.5 }, { 0.75, 5.6, 1.7 }, { 0.93, 3.6, 1.2 }, { 1, 0, 0 } },
    bend = 60, material = look, lift = true,
  }
end

-- The fill goes from the head's left over the back to its right.
local left  = lock(66, 10.5)
local back  = lock(180, 9)
local sides = coif.fill { left, back, left:mirrored(), around = 40, everywhere = true, lift = true }

-- The fringe goes over the face: from right to left by the front.
local function fringe(azimuth, low)
  return coif.tuft {
    stroke = { at(azimuth, 74, 0), at(azimuth, 58, 2.0), at(azimuth, 38, 2.4), at(azimuth, 20, 1.7), at(azimuth * 0.97, low, 1.0) },
    profile = { { 0, 1, 0.8 }, { 0.35, 3.4, 1.3 }, { 0.8, 4.2, 1.2 }, { 0.95, 2.6, 0.8 }, { 1, 0, 0 } },
    bend = 40, material = look, lift = true,
  }
end
local front = {}
for i = -4, 4 do table.insert(front, fringe(13.5 * i, 3 - 0.25 * math.abs(i) + (i % 2))) end

-- Between fringe and bob, before the ears: a narrow lock that frames the face and hides the hairline.
local frame = {}
for _, place in { { 60, 9.4, 2.8 }, { 53, 7.4, 2.6 } } do
  local azimuth, fall, width = place[1], place[2] * p.length, place[3]
  local over = at(azimuth, 2, 2.0)
  table.insert(frame, coif.tuft {
    stroke = {
      at(azimuth, 72), at(azimuth, 54, 1.9), at(azimuth, 28, 2.2), over,
      over - vector.create(0.2, 0.55 * fall, 0.1), over - vector.create(1.3, fall, 0.1),
    },
    profile = { { 0, 0.8, 0.7 }, { 0.3, width, 1.2 }, { 0.75, width, 1.2 }, { 1, 0, 0 } },
    bend = 40, material = look, lift = true,
  })
end
for i = 1, 2 do table.insert(frame, frame[i]:mirrored()) end

-- The cap ends under the fringe and the frame, so that its border is nowhere to be seen.
local border = {}
for _, place in { { 0, 30 }, { 36, 28 }, { 62, 20 }, { 84, 10 }, { 108, -14 }, { 140, -34 }, { 180, -40 } } do
  table.insert(border, at(place[1], place[2]))
end
for i = 6, 2, -1 do table.insert(border, vector.create(-border[i].x, border[i].y, border[i].z)) end

return coif.scene {
  head, coif.cap { border = border, thickness = 1, material = look }, sides, frame, front,
  shading = "toon", skin = "#f6d7c0", views = { "front", "three-quarter", "left", "back" },
}
