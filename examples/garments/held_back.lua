-- held_back.lua: a shirt let out over the bust while its back is held still. The lattice is moved by hand: feature points
-- at the front come forward, the back is fixed, what is between follows. The debug view shows the control points by kind.
local p = coif.params {
  forward = { 9, min = 0, max = 16, unit = "cm", doc = "how far the front comes forward" },
}

local shirt = coif.garment.shirt { sleeves = 18, colour = "#6f8f7a" }

-- bust and waist have a net each: this one is of the bust
local net = coif.lattice {
  around = coif.box { min = { -22, -52, -16 }, max = { 22, -24, 12 } }, margin = 0, divisions = { 4, 6, 4 },
}
net = net
  :mark { kind = "fixed", k = { 0, 1 } }
  :mark { kind = "fixed", j = { 0, 1 } }
  :mark { kind = "fixed", j = { 5, 6 } }
  :mark { kind = "feature", i = { 1, 3 }, j = { 2, 4 }, k = 4 }
  :group { name = "front", i = { 1, 3 }, j = { 2, 4 }, k = 4 }
  :move { group = "front", by = { 0, 0, p.forward } }
  :follow { power = 3 }

local after = shirt:deform { net }:material { colour = "#8f6f7a" }
print(string.format("bust %.1f cm, then %.1f cm", shirt:girth { tape = "bust" }, after:girth { tape = "bust" }))

return coif.scene {
  shirt:shifted { 0, 0, -34 }, after:shifted { 0, 0, 34 }, views = { "left", "three-quarter" },
}
