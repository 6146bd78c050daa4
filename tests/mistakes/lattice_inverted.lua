local net = coif.lattice { corner = { 0, 0, 0 }, edges = { { 1, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 } } }
