local adult, child = coif.head(), coif.head { style = "cartoon" }
local region = adult:scalp() - child:scalp()
