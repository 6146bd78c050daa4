local tie = coif.domain.gather { core = { 0, 5, -10 }, scatter = -0.5 }
