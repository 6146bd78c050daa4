local head = coif.head { file = "inner/cubee.obj" }
