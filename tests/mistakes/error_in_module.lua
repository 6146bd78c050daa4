local bun = require "inner/bun"
local function make()
  return bun.make(nil)
end
return make()
