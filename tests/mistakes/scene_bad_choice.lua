return coif.scene {
  views = { "front", "lefft" },
  background = "black",
}
