local head = coif.head()
local queue = coif.queue {
  coif.domain.gahter { core = head:at("occiput") },
}
