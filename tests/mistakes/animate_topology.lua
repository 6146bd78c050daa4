local head = coif.head { style = "cartoon" }
local top = head:at("vertex")
local one = coif.tuft { stroke = { top, top + vector.create(0, 8, 0) }, sides = 8 }
local two = coif.tuft { stroke = { top, top + vector.create(2, 8, 0) }, sides = 8, tips = 2 }
local moving = coif.animate {
  states = { one, two },
  path = coif.path { states = { 1, 2 } },
}
return coif.scene { head, moving }
