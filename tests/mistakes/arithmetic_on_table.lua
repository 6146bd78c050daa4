local knot = { 0, 3, -4 }
return knot + 2
