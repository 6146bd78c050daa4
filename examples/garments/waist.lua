-- waist.lua: one dress before and after its waist is let out from 57 to 67 cm, with the tape drawn in: figures 5 and 8
-- of the deformation paper. The bust is fitted to 88.7 cm in the same step.
local p = coif.params {
  waist = { 67, min = 45, max = 90, unit = "cm", doc = "girth of the waist afterwards" },
  bust  = { 88.7, min = 75, max = 110, unit = "cm", doc = "girth of the bust afterwards" },
}

local before = coif.garment.dress { waist = 57, bust = 84, colour = "#5f7fa8" }
local after  = before:fit { waist = p.waist, bust = p.bust }:material { colour = "#a85f6d" }

-- side by side, each with its tapes
local function pair(dress, x)
  local there = dress:shifted { x, 0, 0 }
  return { there, there:ribbon { tape = "waist" }, there:ribbon { tape = "bust", colour = "#f5efe0" } }
end

print(string.format("waist %.2f cm, bust %.2f cm", after:girth { tape = "waist" }, after:girth { tape = "bust" }))

return coif.scene { pair(before, -42), pair(after, 42), views = { "front" } }
