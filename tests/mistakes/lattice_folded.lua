local head = coif.head()
local net = coif.lattice { around = head, divisions = { 2, 2, 2 } }
net = net:move { i = 2, j = 2, k = 2, by = { -60, -90, -60 } }
return coif.scene { head:deform { net } }
