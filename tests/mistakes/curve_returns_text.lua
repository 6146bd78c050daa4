local head = coif.head()
local zigzag = coif.domain.natural {
  box = head:box("behind"),
  curve = function(u) return if u > 0.5 then "up" else "down" end,
}
