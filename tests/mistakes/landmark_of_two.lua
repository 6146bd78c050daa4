local head = coif.head()
local knot = head:at("temple", { 0, 3 })
