-- top_bun.lua: combed up into a bun on the crown, with a parted fringe and long side locks.
-- After the third character of Ren, Zhao, Geng 2010. The fine hair at the nape is strands: both kinds in one style.
local p = coif.params {
  hair    = { "#8a4b2a", doc = "colour of the hair" },
  ribbon  = { "#2f9e8f", doc = "colour of the ribbon" },
  strands = { 1400, min = 100, max = 20000, doc = "strands at the nape" },
}

local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = p.hair, shine = 0.6 }

local function at(azimuth, elevation, height)
  return head:point { azimuth = azimuth, elevation = elevation, height = height or 0 }
end

local axis = vector.create(0, 1, -0.35)
local knot = at(180, 72, 0.6)

-- Combed: flat locks from the hairline over the skull to the knot.
local combed = {}
local function comb(azimuth, elevation, width)
  local points = { at(azimuth, elevation) }
  for _, t in { 0.22, 0.45, 0.68, 0.86 } do
    local way = vector.normalize(points[1] + (knot - points[1]) * t - head.centre)
    table.insert(points, at(math.deg(math.atan2(way.x, way.z)), math.deg(math.asin(way.y)), 0.75))
  end
  table.insert(points, knot + 0.6 * axis)
  return coif.tuft {
    stroke = points, bury = true, material = look, bend = 30,
    profile = { { 0, 0.6 * width, 0.8 }, { 0.35, width, 1.1 }, { 0.8, 0.55 * width, 1 }, { 1, 0.8, 0.8 } },
  }
end
for _, place in { { 20, 44, 4.4 }, { 45, 41, 4.6 }, { 68, 32, 4.8 }, { 88, 24, 5 }, { 108, 6, 5.6 }, { 131, -14, 5.6 }, { 156, -24, 5.4 } } do
  local lock = comb(place[1], place[2], place[3])
  table.insert(combed, lock)
  table.insert(combed, lock:mirrored())
end
table.insert(combed, comb(180, -26, 5.2))
table.insert(combed, comb(0, 45, 4.4))

local bun = coif.bun {
  position = knot + 3.1 * vector.normalize(axis), axis = axis, radius = 4.4, length = 7, grooves = 9, swirl = 150,
  material = look,
}
local ribbon = coif.bun { position = knot + 0.5 * vector.normalize(axis), axis = axis, radius = 3.4, length = 1.6, material = p.ribbon }

-- The fringe parts over the left brow.
local function fringe(azimuth, lean, length, width)
  return coif.tuft {
    stroke = {
      at(12 + 0.2 * azimuth, 60), at(12 + 0.55 * azimuth, 50, 2.2), at(6 + azimuth, 34, 2.2),
      at(4 + azimuth + 0.6 * lean, 20, 1.5), at(azimuth + lean, 20 - length, 0.9),
    },
    profile = { { 0, 1, 0.8 }, { 0.45, width, 1.4 }, { 0.8, 0.6 * width, 1 }, { 1, 0, 0 } },
    bend = 40, material = look, lift = true,
  }
end
local front = {
  fringe(-52, -8, 26, 4.6), fringe(-36, -10, 17, 4.6), fringe(-20, -10, 13, 4.4), fringe(-4, -8, 10, 4),
  fringe(22, 12, 14, 4.2), fringe(38, 16, 24, 4.4),
}

-- Side locks to the collar bones.
local side = coif.tuft {
  stroke = { at(62, 40), at(64, 26, 1.8), at(65, 4, 1.6), at(62, -24, 1.8), at(56, -46, 2.6), at(50, -60, 5.4) },
  profile = { { 0, 1, 0.8 }, { 0.35, 3.0, 1.4 }, { 0.75, 2.4, 1.1 }, { 1, 0, 0 } },
  material = look, lift = true,
}

-- Strands: the short hair of the nape that no comb reaches.
local nape = head:scalp():where(function(place) return place.y < -1.5 and place.z < -4 end)
local wisps = nape:guides { count = 60, length = 3, length_variation = 0.5, stiffness = 2 }
  :grow { global = coif.queue { coif.domain.directional { box = head:box("all"), direction = { 0, -1, 0.15 }, noise = 0.15 } } }
  :fill { strands = p.strands, clump = 0.7, material = coif.material.hair {
    root_colour = p.hair, tip_colour = p.hair, width = 0.05, shine = 0,
  } }

return coif.scene {
  head, coif.cap { thickness = 0.7, material = look }, combed, bun, ribbon, front, side, side:mirrored(), wisps,
  shading = "toon", skin = "#f3cfb4", views = { "front", "three-quarter", "left", "back" },
}
