return math.flor(3.5)
