return coif.path { points = { { 0, 0, 0 }, { 4, 0, 0 }, { 4, 4, 0 } }, times = { 0, 2, 1 } }
