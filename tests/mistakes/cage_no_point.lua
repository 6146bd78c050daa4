local head = coif.head()
local cage = coif.cage { around = head, divisions = 2 }
cage = cage:move { points = 27, by = { 0, 1, 0 } }
return coif.scene { head:deform { cage } }
