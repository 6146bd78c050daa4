return coif.scene { coif.head(), still = 3 }
