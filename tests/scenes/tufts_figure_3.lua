-- Figure 3 of Shimosoyama, Yamamoto, Noma 2015: one stroke with several parameters.
-- The paper's: (a) d = 25 and d = 100, (b) p = 10 and p = 80. Chosen here: p = 30 in (a), d = 60 in (b), the stroke.
local head = coif.head { style = "cartoon" }

local function tuft(azimuth, d, p)
  local function at(elevation, height) return { azimuth = azimuth, elevation = elevation, height = height } end
  return coif.tuft { stroke = { at(46), at(47, 7), at(40, 14), at(28, 19) }, diameter = d, peak = p, bury = true }
end

local all = tuft(-66, 25, 30) + tuft(-24, 100, 30) + tuft(24, 60, 10) + tuft(66, 60, 80)
assert(all.count == 4)
return coif.scene { head, all, shading = "toon", views = { "front", "three-quarter" } }
