-- swept_back.lua: swept back from a high brow into a mane of pointed locks behind the head.
local p = coif.params {
  volume = { 1, min = 0.6, max = 1.6, doc = "height of the hair over the skull, as a factor" },
  hair   = { "#c2462e", doc = "colour of the hair" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, tip_colour = "#e8803c", light = "#f6a97c", shine = 0.45, tones = 3 }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

-- A lock from the hairline over the skull to a tip that stands off behind. `hook` carries the end past the tip's
-- direction and back again, so that it ends in a curl to that side.
local function swept(azimuth, elevation, rise, tip, width, hook)
  local root = at(azimuth, elevation)
  local out  = vector.normalize(root - head.centre)
  local h    = rise * p.volume
  local function over(t, height)
    -- Between the root's direction and the tip's.
    local way = vector.normalize(out * (1 - t) + vector.normalize(tip - head.centre) * t)
    return at(math.deg(math.atan2(way.x, way.z)), math.deg(math.asin(way.y)), height)
  end
  local last = over(0.86, 0.8 * h + 1.2)
  local side = vector.normalize(vector.cross(tip - last, vector.create(0, 1, 0))) * (hook or 0)
  return coif.tuft {
    stroke = { root, over(0.08, 0.5 * h), over(0.30, h), over(0.62, 0.9 * h), last - 0.4 * side, tip + side },
    profile = { { 0, 0.5, 0.4 }, { 0.12, 0.7 * width, 1.2 }, { 0.35, width, 1.8 }, { 0.72, 0.72 * width, 1.6 }, { 1, 0, 0 } },
    bend = 40, material = look, bury = true,
  }
end

local mane = {}
local function lock(azimuth, elevation, rise, x, y, z, width, hook)
  table.insert(mane, swept(azimuth, elevation, rise, vector.create(x, y, z), width, hook))
end
-- From the brow over the top: the tips gather into three horns, each of them a long lock between shorter ones.
lock(0, 16, 3.2, -0.6, 17.6, -19.5, 5.4, 0.8)
lock(-11, 16, 3.0, -3.2, 15.2, -16.5, 5.0, 1.2)
lock(11, 16, 3.0, 2.0, 15.6, -17.5, 5.0, -0.8)
lock(22, 14, 2.9, 5.6, 14.6, -21.0, 5.4, -1.0)
lock(-22, 14, 2.9, -6.0, 13.6, -20.0, 5.4, 1.0)
lock(32, 10, 2.7, 7.4, 11.0, -17.0, 4.8, -1.4)
lock(-32, 10, 2.7, -8.0, 10.6, -17.5, 5.0, 1.2)
lock(41, 5, 2.4, 10.2, 9.6, -19.5, 5.2, 0.6)
lock(-41, 5, 2.4, -9.6, 8.4, -18.5, 5.0, -0.4)
lock(49, -2, 2.0, 10.2, 5.4, -15.5, 4.6, -1.2)
lock(-49, -2, 2.0, -11.2, 5.8, -17.0, 4.8, 0.8)
lock(56, -8, 1.6, 12.4, 3.0, -16.5, 4.8, 0.6)
lock(-56, -8, 1.6, -11.2, 2.0, -14.5, 4.6, -0.8)
lock(63, -9, 1.3, 11.2, -1.6, -12.5, 4.0, -0.8)
lock(-63, -9, 1.3, -12.0, -0.6, -14.0, 4.4, 0.8)
lock(71, -4, 1.0, 10.8, -4.0, -12.0, 3.6, 0.6)
lock(-71, -4, 1.0, -10.2, -5.0, -11.5, 3.6, -0.6)
-- The crown: broad locks that part at the whorl and turn to one side.
lock(164, 70, 2.4, 1.4, 9.0, -22.0, 6.0, 0.6)
lock(-150, 64, 2.2, -5.2, 7.2, -20.5, 6.0, -0.8)
lock(118, 62, 2.2, 7.4, 6.6, -19.0, 5.6, 0.8)
-- Under them, the back in two staggered rows that fall and turn outward.
lock(172, 42, 1.9, -0.6, 3.4, -22.5, 6.2, -1.8)
lock(142, 40, 1.8, 5.2, 4.2, -19.5, 5.4, 1.4)
lock(-142, 36, 1.8, -6.4, 3.0, -20.0, 5.8, -1.0)
lock(112, 30, 1.5, 10.4, 1.4, -16.0, 5.0, 0.8)
lock(-114, 28, 1.5, -10.4, 0.2, -15.0, 5.0, -1.2)
lock(158, 14, 1.5, 2.6, -3.6, -20.0, 5.6, 1.6)
lock(-166, 10, 1.5, -2.4, -5.8, -17.5, 5.0, -1.0)
lock(128, 10, 1.3, 7.6, -3.8, -15.5, 5.2, 1.0)
lock(-132, 8, 1.3, -7.0, -4.6, -16.0, 5.4, -1.4)
lock(104, 6, 1.1, 10.2, -6.0, -10.5, 4.4, 0.6)
lock(-102, 6, 1.1, -10.4, -5.6, -10.0, 4.4, -0.6)
-- Short hair at the nape.
lock(180, -12, 0.9, 0.6, -9.6, -12.5, 5.0, 0.8)
lock(150, -10, 0.9, 4.8, -9.0, -11.5, 4.6, 0.8)
lock(-152, -10, 0.9, -4.2, -9.4, -11.5, 4.6, -0.6)

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
