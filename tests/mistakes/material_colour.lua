local m = coif.material.hair {
  root_colour = "brown",
  tip_colour = { 200, 180, 90 },
  shine = 3,
}
