local head = coif.head { unit = "mm" }
