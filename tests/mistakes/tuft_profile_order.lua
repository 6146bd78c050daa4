local head = coif.head()
local stroke = { head:point { elevation = 90 }, head:point { elevation = 90, height = 8 } }
local spike = coif.tuft { stroke = stroke, profile = { { 0, 1, 1 }, { 0.6, 2, 1 }, { 0.4, 2, 1 }, { 1, 0, 0 } } }
return coif.scene { head, spike }
