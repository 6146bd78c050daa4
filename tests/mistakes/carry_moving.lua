local adult, cartoon = coif.head(), coif.head { style = "cartoon" }
local fall = coif.domain.directional { box = adult:box("all"), direction = { 0, -1, -0.1 } }
local hair = adult:scalp():guides { count = 20, length = 10 }:grow { global = coif.queue { fall } }
local turn = adult:motion { { time = 0 }, { time = 0.5, yaw = 20 } }
return coif.scene { cartoon, hair:simulate { motion = turn }:carry { to = cartoon } }
