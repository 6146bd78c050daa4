local broken = require "inner/broken"
