-- ponytail.lua: gather to a tie at the back of the head, then fall in loose curls
local p = coif.params {
  length = { 45, min = 10, max = 80, unit = "cm", doc = "longest strand" },
  tie    = { 1.2, min = 0.5, max = 3, unit = "cm", doc = "radius of the tie" },
}

local head = coif.head()
local knot = head:at("occiput", { 0, 3, -4 })      -- a landmark plus an offset, in head space

local function side(temple, sign)                  -- one local queue for each side
  return coif.queue {
    coif.domain.gather { priority = 2, core = head:at(temple, { sign, 2, -3 }), core_radius = 2 },
    coif.domain.gather { priority = 1, core = knot, core_radius = p.tie, scatter = -0.5, direction = { 0, 0.4, -1 } },
  }
end

local guides = head:scalp():guides { count = 800, length = p.length, step = 0.5, stiffness = 3 }
local hair = guides
  :grow {
    global = coif.queue { coif.domain.directional { box = head:box("behind"), direction = { 0, -1, -0.1 } } },
    locals = { { where = function(root) return root.x >= 0 end, queue = side("left_temple", 1) },
               { where = function(root) return root.x < 0 end,  queue = side("right_temple", -1) } },
  }
  :natural { coif.domain.curl { box = head:box("behind"), period = 6, radius = 0.6, smooth = 0.25 } }
  :fill { strands = 40000, noise = 0.03 }

return coif.scene { head, hair, views = { "front", "left", "back" } }
