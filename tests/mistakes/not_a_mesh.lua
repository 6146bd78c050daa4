local head = coif.head { file = "inner/bun.lua" }
