local looks = require "coif/look"
