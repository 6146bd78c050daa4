local fall = coif.domain.directional {
  box = { centre = { 0, 0, 0 }, size = { 10, 0, 10 } },
  direction = { 0, 0, 0 },
  strenght = 2,
  priority = 1.5,
  noise = "0.1",
}
