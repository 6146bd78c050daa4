local head = coif.head { style = "cartoon" }
local look = coif.material.tuft { colour = "#3f7fc4", tones = 5 }
return coif.scene { head, coif.cap { material = look }, shading = "toon" }
