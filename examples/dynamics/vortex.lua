-- vortex.lua: a vortex over each shoulder, with an attractor on its axis, rolls the locks at the front into curls.
-- A vortex never stops to push, so the air is thick and what still creeps counts as at rest.
local looks = require "coif/looks"

local p = coif.params {
  turn    = { 1300, min = 0, max = 6000, unit = "cm/s^2", doc = "strength of the vortices" },
  guides  = { 500, min = 50, max = 2000, doc = "how many strands are moved" },
  strands = { 20000, min = 500, max = 200000, doc = "how many strands" },
}

local head = coif.head()
local forces = { coif.force.gravity {} }

for _, side in { 1, -1 } do
  local axis = head:at("chin", { 11 * side, -8, -3 })
  local near = coif.ball { centre = axis, radius = 9 }
  table.insert(forces, coif.force.vortex {
    centre = axis, axis = { 0, 0, -side }, core = 4, strength = p.turn, zone = near, edge = 3,
  })
  table.insert(forces, coif.force.attractor { centre = axis, radius = 3, strength = 2500, zone = near, edge = 3 })
end

local hair = head:scalp():parting { head:at("forehead"), head:at("vertex") }
  :guides { count = p.guides, length = 36, length_variation = 0.1, step = 1.5, stiffness = 1.5,
    lay_from = head:at("forehead", { 0, 0, 2 }), lay_amount = 0.95 }
  :grow {}
  :settle { hold = 2.3, drag = 60, rest_speed = 5, forces = forces }
  :fill { strands = p.strands, clump = 0.25, clump_start = 0.3, thickness = 0.6, material = looks.brown }

return coif.scene { head, hair, views = { "front", "three-quarter", "left", "back" } }
