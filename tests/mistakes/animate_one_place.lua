local head = coif.head { style = "cartoon" }
local top = head:at("vertex")
local function locks(x)
  local one = coif.tuft { stroke = { top, top + vector.create(0, 4, 0), top + vector.create(x, 8, 0) }, sides = 8 }
  return one + one:rotated { angle = 90, axis = { 1, 0, 0 } }
end
local moving = coif.animate {
  states = { locks(0), locks(3) },
  path = coif.path { points = { { 0, 20, 0 }, { 4, 20, 0 } } },
}
return coif.scene { head, moving }
