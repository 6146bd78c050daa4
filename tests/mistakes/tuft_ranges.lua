local head = coif.head()
local spike = coif.tuft {
  stroke = { head:point { elevation = 90 }, head:point { elevation = 90, height = 8 } },
  diameter = 120, peak = 0, colour = "#f00", material = "red",
}
return coif.scene { head, spike }
