return { coif.scene { } }
