local head = coif.head()
local knot = head:at("temple", { 1, 2, -3 })
