local t = { grow = 1 }
t.fill { strands = 3 }
