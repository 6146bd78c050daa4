local head = coif.head { style = "cartoon" }
local tuft = coif.tuft { stroke = { { 0, 12, 0 }, { 0, 20, 0 } }, diameter = 3, peak = 50, bury = true }
local many = tuft:array { count = 30, step = 12 }
return coif.scene { head, many:array { count = 1000, step = 1 }:array { count = 1000, step = 1 } }
