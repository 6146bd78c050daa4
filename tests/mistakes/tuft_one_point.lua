local head = coif.head()
local spike = coif.tuft { stroke = { head:point { elevation = 60 } } }
return coif.scene { head, spike }
