local scene = coif.scene { coif.head() }
