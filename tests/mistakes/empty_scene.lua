return coif.scene { views = {} }
