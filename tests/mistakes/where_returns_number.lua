local head = coif.head()
local left = head:scalp():where(function(place) return place.x end)
