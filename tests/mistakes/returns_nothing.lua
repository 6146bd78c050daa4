local scene = coif.scene { }
