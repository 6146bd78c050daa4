local jaw = coif.pins { { at = { 0, 0, 0 }, to = { 0, 1, 0 } } }
