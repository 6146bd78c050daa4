local net = coif.lattice { around = coif.head(), divisions = { 2, 4, 2 } }
net:move { j = 5, by = { 0, 1, 0 } }
