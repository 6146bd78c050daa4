local head = coif.head()
local nothing = head:scalp():where(function(place) return place.y > 100 end)
local guides = nothing:guides { count = 10 }
