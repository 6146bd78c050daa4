-- set: length=900 colour=green
local p = coif.params {
  length = { 45, min = 10, max = 80, unit = "cm" },
  colour = { "#332211", doc = "colour of the tips" },
}
return p
