local spike = coif.tuft { stroke = { { 0, 14, 0 }, { 0, 20, 0 } } }
return coif.scene { spike }
