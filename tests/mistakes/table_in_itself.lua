local t = {}
t.t = t
return coif.scene(t)
