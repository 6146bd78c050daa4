local head = coif.head()
local wave = coif.domain.wave { box = head:box("behind"), period = 4, name = "wave" }
local queue = coif.queue { wave }
