local x = require "../../src/secret"
