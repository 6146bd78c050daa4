return coif.path { points = { { 0, 0, 0 }, { 4, 0, 0 } }, offsets = { { 0, 0, 0 }, { 4, 0, 0 } } }
