-- What the editor definitions must catch: a checker has to complain about every marked line, and about no other.
local head  = coif.head { style = "cartoon" }
local black = coif.material.hair { width = "thin" } -- wrong
local red   = coif.material.hair { root_colour = { 1, 0, 0 } }

local a = coif.domain.gahter { core = { 0, 0, 0 } } -- wrong
local b = coif.domain.gather { core_radius = 2 } -- wrong
local c = coif.domain.gather { core = "here" } -- wrong
local d = coif.domain.gather { core = { 1, 2 } } -- wrong
local e = coif.domain.gather { core = head:at("occiput", { 0, 2, -3 }) + 2 * coif.up }
local f = coif.domain.curl { box = { min = { -1, -1, -1 }, max = { 1, 1, 1 } }, period = 3, turn = "widdershins" } -- wrong

local at    = head:at("tmple") -- wrong
local scale = head.scael -- wrong
local scalp = head:scalp()
local both  = scalp + scalp - scalp
local guides = both:guides { count = "ten" } -- wrong
local grown = both:guides { count = 10 }:grow { locals = { { where = 3, queue = coif.queue { e } } } } -- wrong
local queue = coif.queue { 3 } -- wrong
local test  = scalp:where(function(place) return place.w > 0 end) -- wrong
local far   = (coif.up * 2 + coif.left).length -- wrong
local hair  = both:guides {}:grow {}:fill { strands = 10, material = { root_colour = "#000000" }, neighbours = 2 }
local dyed  = hair:material(red):material { width = 0.1 }
local bald  = hair:material("red") -- wrong
local half  = vector.create(1, 2, 3) / 2
local sum   = vector.dot(half, -half) + vector.nom(half) -- wrong
local p     = coif.params { length = { 3, min = "one" } } -- wrong

return coif.scene { head, dyed, views = { "front", "behind" } } -- wrong
