-- Figure 11 of Shimosoyama, Yamamoto, Noma 2015: the two tufts of figure 10, filled by various densities m_W (around),
-- m_U (up) and m_D (down), without jitter and, in its picture (d2), with.
-- The paper's: densities are whole numbers from 1 to 100, jitter moves a root by up to pi/20 = 9 degrees in azimuth and
-- elevation (`jitter = 1`). It prints no densities with the pictures; chosen here: m_W = 60, no rows; `--set` gives others.
local p = coif.params {
  around = { 60, min = 1, max = 100, doc = "m_W" },
  up     = { 0, min = 0, max = 100, doc = "m_U; 0 for no rows" },
  down   = { 0, min = 0, max = 100, doc = "m_D; 0 for no rows" },
  jitter = { 0, min = 0, max = 1, doc = "1 strews roots by 9 degrees" },
}
local head = coif.head { style = "cartoon" }
local function tuft(azimuth, d, peak)
  return coif.tuft {
    stroke = {
      { azimuth = azimuth, elevation = 42 }, { azimuth = azimuth, elevation = 40, height = 4 },
      { azimuth = azimuth, elevation = 20, height = 7 }, { azimuth = azimuth, elevation = -8, height = 6 },
    },
    diameter = d, peak = peak, bury = true,
  }
end
local filled = coif.fill {
  tuft(50, 60, 40), tuft(-50, 36, 30),
  around = p.around, up = p.up > 0 and p.up or nil, down = p.down > 0 and p.down or nil, jitter = p.jitter,
}
print(filled.count)
return coif.scene { head, filled, shading = "toon", views = { "front", "left", "back", "right" } }
