local head = coif.head { "mannequin", style = "cartoonish" }
