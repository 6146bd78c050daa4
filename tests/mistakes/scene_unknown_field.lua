return coif.scene {
  views = { "front" },
  backgruond = "dark",
}
