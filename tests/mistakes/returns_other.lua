return { coif.scene { coif.head() } }
