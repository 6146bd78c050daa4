local area = coif.box { centre = { 0, 10, 0 }, max = { 1, 1, 1 } }
