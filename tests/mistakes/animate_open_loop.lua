local head = coif.head { style = "cartoon" }
local top = head:at("vertex")
local function lock(x)
  return coif.tuft { stroke = { top, top + vector.create(0, 4, 0), top + vector.create(x, 8, 0) }, sides = 8 }
end
local moving = coif.animate {
  states = { lock(0), lock(3) },
  path = coif.path { states = { 1, 2 }, frames = 12 },
  loop = true,
}
return coif.scene { head, moving }
