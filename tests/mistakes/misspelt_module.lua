local bun = require "inner/bunn"
