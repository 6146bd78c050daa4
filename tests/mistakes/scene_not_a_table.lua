return coif.scene("front")
