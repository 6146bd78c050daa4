local head = coif.head()
local tie = coif.domain.gather { core_radius = 2 }
