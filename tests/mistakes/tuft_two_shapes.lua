local head = coif.head()
local stroke = { head:point { elevation = 90 }, head:point { elevation = 90, height = 8 } }
local spike = coif.tuft {
  stroke = stroke, ellipse = { horizontal = 2, vertical = 1 }, profile = { { 0, 1, 1 }, { 1, 0, 0 } },
}
return coif.scene { head, spike }
