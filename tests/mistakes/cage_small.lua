local head = coif.head()
local cage = coif.cage { around = coif.box { min = { -6, -8, 2 }, max = { 6, 4, 16 } }, margin = 0 }
cage = cage:move { by = { 0, 4, 0 } }
return coif.scene { head:deform { cage } }
