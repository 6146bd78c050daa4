local style = {}
local function knot()
  return style.head.position
end
return knot()
