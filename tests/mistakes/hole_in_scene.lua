local head = coif.head()
local fringe
return coif.scene { fringe, head }
