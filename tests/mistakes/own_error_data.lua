error { code = 3, "odd" }
