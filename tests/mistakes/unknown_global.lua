local lenght = 3
return coif.scene { views = { "front" }, background = lengt }
