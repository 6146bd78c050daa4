-- swept_back.lua: swept back from a high brow into a mane of pointed locks behind the head.
local p = coif.params {
  volume = { 1, min = 0.6, max = 1.6, doc = "height of the hair over the skull, as a factor" },
  hair   = { "#c2462e", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, tip_colour = "#e8803c", shine = 0.5 }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

-- A lock from the hairline over the skull to a tip that stands off behind.
local function swept(azimuth, elevation, rise, tip, width)
  local root = at(azimuth, elevation)
  local out  = vector.normalize(root - head.centre)
  local h    = rise * p.volume
  local function over(t, height)
    -- Between the root's direction and the tip's.
    local way = vector.normalize(out * (1 - t) + vector.normalize(tip - head.centre) * t)
    return at(math.deg(math.atan2(way.x, way.z)), math.deg(math.asin(way.y)), height)
  end
  return coif.tuft {
    stroke = { root, over(0.08, 0.5 * h), over(0.30, h), over(0.62, 0.9 * h), over(0.86, 0.8 * h + 1.2), tip },
    profile = { { 0, 0.5, 0.4 }, { 0.12, 0.7 * width, 1.2 }, { 0.35, width, 1.8 }, { 0.72, 0.72 * width, 1.6 }, { 1, 0, 0 } },
    bend = 40, material = look, bury = true,
  }
end

local mane = {}
local function pair(azimuth, elevation, rise, tip, width)
  local lock = swept(azimuth, elevation, rise, tip, width)
  table.insert(mane, lock)
  if azimuth ~= 0 and azimuth ~= 180 then table.insert(mane, lock:mirrored()) end
end
-- From the brow, the highest farthest back.
pair(0, 16, 3.0, vector.create(0, 15.5, -18), 5.2)
pair(11, 16, 3.0, vector.create(2.6, 15.0, -18.5), 5.2)
pair(22, 14, 2.9, vector.create(5.0, 13.6, -18.5), 5.2)
pair(32, 10, 2.7, vector.create(7.2, 11.5, -18.5), 5.2)
pair(41, 5, 2.4, vector.create(9.0, 9.0, -18), 5.0)
pair(49, -2, 2.0, vector.create(10.4, 6.0, -17), 5.0)
pair(56, -8, 1.6, vector.create(11.2, 2.6, -15.5), 4.8)
pair(63, -9, 1.3, vector.create(11.4, -1.0, -14), 4.4)
pair(71, -4, 1.0, vector.create(10.4, -4.5, -12.5), 3.6)
-- Under them, the locks of the back.
pair(180, 62, 2.0, vector.create(0, 8.5, -21), 6)
pair(152, 56, 2.0, vector.create(5.4, 6.0, -20.5), 6)
pair(126, 44, 1.8, vector.create(9.4, 2.5, -18), 5.8)
pair(166, 34, 1.7, vector.create(2.8, 1.5, -20), 6)
pair(140, 24, 1.6, vector.create(7.0, -2.0, -18), 5.8)
pair(112, 18, 1.3, vector.create(10.4, -4.5, -11.5), 5)
pair(180, 10, 1.4, vector.create(0, -5.0, -17.5), 5.6)
pair(154, 4, 1.3, vector.create(4.6, -6.5, -15.5), 5.4)
pair(128, -4, 1.1, vector.create(7.6, -8.0, -11.5), 4.8)

-- One lock that would not go back.
local stray = coif.tuft {
  stroke = { at(9, 19), at(5, 24, 2.4), at(-6, 20, 3.6), at(-14, 8, 2.8), at(-17, -6, 1.4) },
  profile = { { 0, 0.5, 0.4 }, { 0.35, 2.0, 0.9 }, { 1, 0, 0 } },
  material = look, lift = true,
}

return coif.scene {
  head, coif.cap { thickness = 0.9, material = p.hair }, mane, stray,
  shading = "toon", skin = "#eac39f", views = { "front", "three-quarter", "left", "back" },
}
