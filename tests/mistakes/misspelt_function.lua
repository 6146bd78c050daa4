return coif.scenne { }
