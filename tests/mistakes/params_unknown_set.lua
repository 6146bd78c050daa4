-- set: lenght=50
local p = coif.params { length = 45 }
return coif.scene { }
