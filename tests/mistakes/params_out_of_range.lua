local p = coif.params {
  length = { 5, min = 10, max = 80, unit = "cm", doc = "longest strand" },
  tie = { 1.2, min = "0.5" },
}
return p
