local braid = require "innr/braid"
