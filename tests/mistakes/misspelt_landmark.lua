local head = coif.head()
local knot = head:at("ociput", { 0, 3, -4 })
