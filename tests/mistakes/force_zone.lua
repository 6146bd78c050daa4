local head = coif.head()
return coif.force.attractor { centre = head:at("nape"), zone = { centre = { 0, 0, 0 }, radius = 3 } }
