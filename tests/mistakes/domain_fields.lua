local head = coif.head()
local fall = coif.domain.directional {
  box = head:box("behnd"),
  direction = { 0, 0, 0 },
}
