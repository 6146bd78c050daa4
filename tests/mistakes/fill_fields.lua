local head = coif.head()
local hair = head:scalp():guides { count = 20, length = 3 }:grow {}
local full = hair:fill { strand = 100, material = { root_color = "#ffffff" }, region = head }
