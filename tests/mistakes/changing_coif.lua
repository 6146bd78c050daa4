coif.seed = 4
