local head = coif.head()
local fall = coif.domain.directional { box = head:box("all"), direction = coif.down }
local hair = head:scalp():guides { count = 5, length = 3 }
  :grow { global = coif.queue { fall } }
  :natural { fall }
