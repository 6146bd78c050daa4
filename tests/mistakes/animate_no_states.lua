local head = coif.head { style = "cartoon" }
local lock = coif.tuft { stroke = { head:at("vertex"), head:at("vertex", { 0, 8, 0 }) }, sides = 8 }
local moving = coif.animate { states = { lock }, path = coif.path { offsets = { { 0, 0, 0 }, { 4, 0, 0 } } } }
return coif.scene { head, moving }
