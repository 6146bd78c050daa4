-- Hair colours as they are found on people, to be used as materials:
--   local looks = require "coif/looks"
--   hair:fill { strands = 40000, material = looks.chestnut }

return {
  black    = coif.material.hair { root_colour = "#0d0a09", tip_colour = "#1d1613", shine = 0.7 },
  brown    = coif.material.hair { root_colour = "#2e1b12", tip_colour = "#6b432b" },
  chestnut = coif.material.hair { root_colour = "#3a1d12", tip_colour = "#7d4427", shine = 0.6 },
  auburn   = coif.material.hair { root_colour = "#45180d", tip_colour = "#8f3b1c", shine = 0.6 },
  red      = coif.material.hair { root_colour = "#7a2e12", tip_colour = "#c4622d", shine = 0.6 },
  blonde   = coif.material.hair { root_colour = "#8a6a3b", tip_colour = "#d9bd84", variation = 0.2 },
  platinum = coif.material.hair { root_colour = "#c2b294", tip_colour = "#efe7d6", variation = 0.1 },
  grey     = coif.material.hair { root_colour = "#6d6a68", tip_colour = "#a9a6a3", variation = 0.25 },
  white    = coif.material.hair { root_colour = "#c9c8c6", tip_colour = "#f1f0ee", variation = 0.1 },
}
