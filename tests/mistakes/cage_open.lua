local head = coif.head()
local cage = coif.cage { mesh = coif.garment.load { file = "open_box.obj" } }
return coif.scene { head:deform { cage } }
