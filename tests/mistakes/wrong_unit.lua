local head = coif.head { file = "inner/cube.obj" }
