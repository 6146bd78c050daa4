---@meta
-- Made by `coif api`: what a hairstyle script can use, for LuaLS and EmmyLua. Do not edit.

---A direction or a place, three numbers: what Luau calls a vector.
---@class vector
---@field x number # To the head's left.
---@field y number # Up.
---@field z number # To the front.
---@operator add(vector): vector
---@operator sub(vector): vector
---@operator mul(vector): vector
---@operator mul(number): vector
---@operator div(vector): vector
---@operator div(number): vector
---@operator idiv(vector): vector
---@operator idiv(number): vector
---@operator unm: vector

---A place: a vector or three numbers, in cm.
---@alias coif.Point vector|{ [1]: number, [2]: number, [3]: number }

---Where to: a vector or three numbers, of any length but zero.
---@alias coif.Direction vector|{ [1]: number, [2]: number, [3]: number }

---A colour: `"#rrggbb"`, or red, green and blue from 0 to 1.
---@alias coif.Colour string|vector|{ [1]: number, [2]: number, [3]: number }

---Luau's vectors.
---@class vectorlib
---@field zero vector # `{ 0, 0, 0 }`
---@field one vector # `{ 1, 1, 1 }`
vector = {}

---A vector of three numbers.
---@param x number
---@param y number
---@param z? number
---@return vector
function vector.create(x, y, z) end

---The length.
---@param v vector
---@return number
function vector.magnitude(v) end

---The same direction with length 1.
---@param v vector
---@return vector
function vector.normalize(v) end

---The dot product.
---@param a vector
---@param b vector
---@return number
function vector.dot(a, b) end

---The cross product.
---@param a vector
---@param b vector
---@return vector
function vector.cross(a, b) end

---The angle between two vectors in radians; with an axis it has a sign.
---@param a vector
---@param b vector
---@param axis? vector
---@return number
function vector.angle(a, b, axis) end

---From `a` at 0 to `b` at 1.
---@param a vector
---@param b vector
---@param t number
---@return vector
function vector.lerp(a, b, t) end

---Each component rounded down.
---@param v vector
---@return vector
function vector.floor(v) end

---Each component rounded up.
---@param v vector
---@return vector
function vector.ceil(v) end

---Each component without its sign.
---@param v vector
---@return vector
function vector.abs(v) end

---Each component's sign: -1, 0 or 1.
---@param v vector
---@return vector
function vector.sign(v) end

---Each component kept between those of two vectors.
---@param v vector
---@param low vector
---@param high vector
---@return vector
function vector.clamp(v, low, high) end

---The least of each component.
---@param v vector
---@param ... vector
---@return vector
function vector.min(v, ...) end

---The greatest of each component.
---@param v vector
---@param ... vector
---@return vector
function vector.max(v, ...) end

---The type's name; `"vector"` for vectors, `"userdata"` for what Coif made.
---@param value any
---@return string
function typeof(value) end

---The angle of the point (x, y), in radians.
---@param y number
---@param x number
---@return number
function math.atan2(y, x) end

---`n` to the power of `exponent`.
---@param n number
---@param exponent number
---@return number
function math.pow(n, exponent) end

---`n` kept between two numbers.
---@param n number
---@param low number
---@param high number
---@return number
function math.clamp(n, low, high) end

---To the nearest whole number.
---@param n number
---@return number
function math.round(n) end

---The sign: -1, 0 or 1.
---@param n number
---@return number
function math.sign(n) end

---From `a` at 0 to `b` at 1.
---@param a number
---@param b number
---@param t number
---@return number
function math.lerp(a, b, t) end

---From the interval `from_low` to `from_high` to another one.
---@param n number
---@param from_low number
---@param from_high number
---@param to_low number
---@param to_high number
---@return number
function math.map(n, from_low, from_high, to_low, to_high) end

---Smooth noise between -1 and 1 that depends on nothing but its arguments.
---@param x number
---@param y? number
---@param z? number
---@return number
function math.noise(x, y, z) end

---Empties a table.
---@param t table
function table.clear(t) end

---A copy of a table, one level deep.
---@generic T: table
---@param t T
---@return T
function table.clone(t) end

---A list of `count` values.
---@generic T
---@param count number
---@param value? T
---@return T[]
function table.create(count, value) end

---Where a value stands in a list; nothing if it does not.
---@generic T
---@param t T[]
---@param value T
---@param from? number
---@return number?
function table.find(t, value, from) end

---Makes a table read-only, and gives it.
---@generic T: table
---@param t T
---@return T
function table.freeze(t) end

---Whether a table is read-only.
---@param t table
---@return boolean
function table.isfrozen(t) end

---The pieces of a text between separators.
---@param text string
---@param separator? string
---@return string[]
function string.split(text, separator) end

---Hairstyles that are written.
---@class coif
---@field up vector # Towards the crown, +Y.
---@field down vector # Towards the feet, -Y.
---@field front vector # Where the face looks, +Z.
---@field back vector # Away from the face, -Z.
---@field left vector # The head's own left, +X.
---@field right vector # The head's own right, -X.
---@field seed number # The seed of this run, from `--seed`; 0 without it.
coif = {}

---@class coif.domain
coif.domain = {}

---@class coif.force
coif.force = {}

---@class coif.material
coif.material = {}

---@class coif.garment
coif.garment = {}

---A parameter, by the name that it shall have.
---@class (exact) coif.params.parameter
---@field [integer] number|boolean|string|coif.Point # What it is unless set from outside: a number, true or false, a text, `"#rrggbb"`, a point.
---@field min? number # Least value of a number.
---@field max? number # Greatest value of a number.
---@field integer? boolean # True when a number must be whole. [default false]
---@field unit? string # Unit of a number, for people.
---@field doc? string # What it means, in one line.
---@field choices? string[] # What a text may be.

---What `coif.params` takes.
---@class (exact) coif.params.fields
---@field [string] coif.params.parameter|number|boolean|string|coif.Point # A parameter, by the name that it shall have.

---Declares the style's parameters and gives their values: the defaults, or what `--set name=value` says. Each is a
---default, or a table of a default with `min`, `max`, `integer`, `unit`, `doc`, `choices`.
---@param fields? coif.params.fields
---@return table<string, any>
function coif.params(fields) end

---What `coif.head` takes.
---@class (exact) coif.head.fields
---@field style? "adult"|"cartoon" # Which mannequin. [default "adult"]
---@field file? string # A mesh instead of the mannequin: OBJ, glTF or GLB, beside the script or below its folder.
---@field unit? "mm"|"cm"|"dm"|"m"|"in"|"ft" # What one unit of the file is; metres for glTF, centimetres for OBJ when left out.
---@field up? "x"|"y"|"z"|"-x"|"-y"|"-z" # The axis of the file that points up; "y" when left out.
---@field forward? "x"|"y"|"z"|"-x"|"-y"|"-z" # The axis of the file that the face looks along; "z", or "-y" when z is up.
---@field groups? string[] # Only these groups, objects or materials of the file; everything when left out.
---@field landmarks? table<string, coif.Point> # Landmarks by name, in the file's own axes and unit, instead of those found from the shape.
---@field carry? boolean # What `--head FILE` does: false grows the style on that head instead of this one; true grows it on this head and carries it to that one, which is right for a style in plain coordinates. [default false]

---The head that hair grows on: the built-in mannequin, or a mesh from a file. `--head FILE` on the command line
---takes the place of either.
---@param fields? coif.head.fields
---@return coif.Head
function coif.head(fields) end

---What `coif.box` takes.
---@class (exact) coif.box.fields
---@field centre? coif.Point # Its middle; goes with `size`. [cm]
---@field size? coif.Point # Its edge lengths, each more than 0; goes with `centre`. [cm]
---@field min? coif.Point # One corner; goes with `max`. [cm]
---@field max? coif.Point # The opposite corner; goes with `min`. [cm]
---@field rotation? coif.Point # Turns about its middle, about the x axis, then y, then z. [degrees; default { 0, 0, 0 }]

---A box: by its middle and edge lengths, or by two opposite corners.
---@param fields? coif.box.fields
---@return coif.Box
function coif.box(fields) end

---What `coif.domain.directional` takes.
---@class (exact) coif.domain.directional.fields
---@field box coif.Box|coif.box.fields # Where it acts.
---@field direction coif.Direction # Where to it draws.
---@field strength? number # Weight among the domains that act together. [0 to 1000; default 1]
---@field priority? number # Order within the queue: higher acts first, equal priorities act together. [whole; default 0]
---@field noise? number # Standard deviation of the gaussian noise on the direction, step by step. [0 to 10; default 0]
---@field name? string # What messages and the debug view call it.

---A directional domain: inside its box hair is drawn in one direction. A strand that has been inside and leaves
---the box is never again acted upon; one that never comes in keeps the domain waiting.
---@param fields coif.domain.directional.fields
---@return coif.Domain
function coif.domain.directional(fields) end

---What `coif.domain.gather` takes.
---@class (exact) coif.domain.gather.fields
---@field core coif.Point # The point it draws to. [cm]
---@field core_radius? number # How near to the core counts as there. [cm; 0 to 1000; default 1]
---@field strength? number # Weight among the domains that act together. [0 to 1000; default 1]
---@field scatter? number # How much of the old tangent stays when it lets go; needs `direction`. [-100 to 100; default 0]
---@field direction? coif.Direction # Where to hair leaves the core; without it the tangent stays as it is.
---@field priority? number # Order within the queue: higher acts first, equal priorities act together. [whole; default 0]
---@field noise? number # Standard deviation of the gaussian noise on the direction, step by step. [0 to 10; default 0]
---@field name? string # What messages and the debug view call it.

---A gather domain: hair is drawn to a core, and let go once it is there, or once it is farther from where it was
---caught than the core is. The tangent t then becomes `direction + scatter * t`: a negative scatter flips the
---spread of a bundle through its knot.
---@param fields coif.domain.gather.fields
---@return coif.Domain
function coif.domain.gather(fields) end

---What `coif.domain.wave` takes.
---@class (exact) coif.domain.wave.fields
---@field box coif.Box|coif.box.fields # Where it acts.
---@field period number # Length of one wave. [cm; 0.05 to 1000]
---@field radius? number # Greatest distance from the axis. [cm; 0 to 100; default 0.4]
---@field radius_tip? number # Radius at the end of the part inside the box; the same as `radius` when left out. [cm; 0 to 100]
---@field smooth? number # Part of the length over which the wave rises at its start. [0.001 to 0.5; default 0.25]
---@field smooth_end? number # Part of the length over which it falls at its end, 0 for not at all; as `smooth` when left out. [0 to 0.5]
---@field phase? number # Where in the wave it starts. [degrees; -360 to 360; default 0]
---@field phase_variation? number # How much the phase differs from guide to guide: 0 not at all, 1 by up to a whole turn. [0 to 1; default 0]
---@field radius_variation? number # How much the radius differs from guide to guide, as a part of it. [0 to 1; default 0]
---@field tilt? number # Turns the plane of the wave about the strand: 0 waves towards the head and away from it, 90 along the head. [degrees; -360 to 360; default 0]
---@field priority? number # Order within the queue: higher acts first. [whole; default 0]
---@field noise? number # Standard deviation of gaussian noise on the displacement, as a part of the radius. [0 to 10; default 0]
---@field name? string # What messages and the debug view call it.

---A natural domain that waves hair in a plane.
---@param fields coif.domain.wave.fields
---@return coif.Domain
function coif.domain.wave(fields) end

---What `coif.domain.curl` takes.
---@class (exact) coif.domain.curl.fields
---@field box coif.Box|coif.box.fields # Where it acts.
---@field period number # Length along the strand of one turn. [cm; 0.05 to 1000]
---@field radius? number # Greatest distance from the axis. [cm; 0 to 100; default 0.5]
---@field radius_tip? number # Radius at the end of the part inside the box; the same as `radius` when left out. [cm; 0 to 100]
---@field flatness? number # The helix's other radius over the first: 1 is round, 0 a plane wave. [0 to 10; default 1]
---@field turn? "right"|"left"|"mirrored"|"random" # Which way it turns. [default "right"]
---@field smooth? number # Part of the length over which the curl rises at its start. [0.001 to 0.5; default 0.25]
---@field smooth_end? number # Part of the length over which it falls at its end, 0 for not at all; as `smooth` when left out. [0 to 0.5]
---@field phase? number # Where in the turn it starts. [degrees; -360 to 360; default 0]
---@field phase_variation? number # How much the phase differs from guide to guide: 0 not at all, 1 by up to a whole turn. [0 to 1; default 0]
---@field radius_variation? number # How much the radius differs from guide to guide, as a part of it. [0 to 1; default 0]
---@field priority? number # Order within the queue: higher acts first. [whole; default 0]
---@field noise? number # Standard deviation of gaussian noise on the displacement, as a part of the radius. [0 to 10; default 0]
---@field name? string # What messages and the debug view call it.

---A natural domain that curls hair into a helix; with `radius_tip` a conical one.
---@param fields coif.domain.curl.fields
---@return coif.Domain
function coif.domain.curl(fields) end

---What `coif.domain.natural` takes.
---@class (exact) coif.domain.natural.fields
---@field box coif.Box|coif.box.fields # Where it acts.
---@field curve fun(u: number): number, number? # Takes a number from 0 to 1, returns the offsets away from the head and to the side, in cm.
---@field over? "period"|"part"|"length" # What the function's number runs over. [default "period"]
---@field period? number # Length along the strand that the function runs over; not used over "part". [cm; 0.05 to 1000; default 5]
---@field smooth? number # Part of the length over which the curve rises at its start. [0.001 to 0.5; default 0.25]
---@field smooth_end? number # Part of the length over which it falls at its end, 0 for not at all; as `smooth` when left out. [0 to 0.5]
---@field phase? number # Where in the period it starts. [degrees; -360 to 360; default 0]
---@field phase_variation? number # How much the phase differs from guide to guide: 0 not at all, 1 by up to a whole period. [0 to 1; default 0]
---@field radius_variation? number # How much the offsets differ from guide to guide, as a part of them. [0 to 1; default 0]
---@field tilt? number # Turns the offsets about the strand. [degrees; -360 to 360; default 0]
---@field priority? number # Order within the queue: higher acts first. [whole; default 0]
---@field noise? number # Standard deviation of gaussian noise on the displacement, as a part of the offset. [0 to 10; default 0]
---@field name? string # What messages and the debug view call it.

---A natural domain with any curve, given as a function of 0 to 1 that returns two offsets in cm: away from the
---head, and to the side.
---@param fields coif.domain.natural.fields
---@return coif.Domain
function coif.domain.natural(fields) end

---What `coif.queue` takes.
---@class (exact) coif.queue.fields
---@field [integer] coif.Domain # Its domains, in any order.

---A queue of domains. Those of equal priority form a stage; only the first stage is visible, and the next one
---becomes so when a strand was let go by every domain of it.
---@param fields coif.queue.fields
---@return coif.Queue
function coif.queue(fields) end

---What `coif.ball` takes.
---@class (exact) coif.ball.fields
---@field centre coif.Point # Its middle. [cm]
---@field radius number # Its radius. [cm; 0.01 to 1000]

---A ball: a part of space for a force to act in, or to pin hair in.
---@param fields coif.ball.fields
---@return coif.Ball
function coif.ball(fields) end

---What `coif.force.gravity` takes.
---@class (exact) coif.force.gravity.fields
---@field strength? number # Acceleration. [cm/s^2; 0 to 1000000; default 981]
---@field direction? coif.Direction # Where to. [default { 0, -1, 0 }]
---@field zone? coif.Box|coif.Ball # The box or ball that it acts in; everywhere when left out.
---@field edge? number # The way inside the zone's border over which it fades out; 0 ends at the border. [cm; 0 to 1000; default 0]
---@field over_time? { number, number }[] | fun(time: number): number # Factors on the strength: pairs of a time in seconds and a factor, or a function from the time to the factor, asked 24 times a second for the first minute. In `settle` it has no say.
---@field follows? boolean # True when it moves with the head. [default false]
---@field name? string # What messages and the debug view call it.

---A constant acceleration: gravity.
---@param fields? coif.force.gravity.fields
---@return coif.Force
function coif.force.gravity(fields) end

---What `coif.force.wind` takes.
---@class (exact) coif.force.wind.fields
---@field direction coif.Direction # Where to it blows.
---@field strength? number # Mean acceleration. [cm/s^2; 0 to 1000000; default 500]
---@field gust? number # How much gusts add and take, as a part of the strength: 0 blows evenly, 1 from calm to twice the strength. [0 to 3; default 0]
---@field period? number # Mean time from gust to gust. [s; 0.05 to 100; default 1]
---@field speed? number # How fast gusts travel. [cm/s; 1 to 100000; default 200]
---@field seed? number # Another seed gives other gusts. [whole; default 0]
---@field zone? coif.Box|coif.Ball # The box or ball that it acts in; everywhere when left out.
---@field edge? number # The way inside the zone's border over which it fades out; 0 ends at the border. [cm; 0 to 1000; default 0]
---@field over_time? { number, number }[] | fun(time: number): number # Factors on the strength: pairs of a time in seconds and a factor, or a function from the time to the factor, asked 24 times a second for the first minute. In `settle` it has no say.
---@field follows? boolean # True when it moves with the head. [default false]
---@field name? string # What messages and the debug view call it.

---Wind: an acceleration in one direction, which may come in gusts. Gusts travel with the wind; in `settle` it
---blows evenly.
---@param fields coif.force.wind.fields
---@return coif.Force
function coif.force.wind(fields) end

---What `coif.force.attractor` takes.
---@class (exact) coif.force.attractor.fields
---@field centre coif.Point # The point it draws to. [cm]
---@field radius? number # Within this distance it does not act. [cm; 0 to 1000; default 1]
---@field rim? number # The way outside of `radius` over which it comes to its full strength. [cm; 0 to 1000; default 0.5]
---@field strength? number # Acceleration at 10 cm from the centre. [cm/s^2; 0 to 1000000; default 1000]
---@field fall_off? "constant"|"proportional"|"inverse" # How it changes with the distance. [default "proportional"]
---@field zone? coif.Box|coif.Ball # The box or ball that it acts in; everywhere when left out.
---@field edge? number # The way inside the zone's border over which it fades out; 0 ends at the border. [cm; 0 to 1000; default 0]
---@field over_time? { number, number }[] | fun(time: number): number # Factors on the strength: pairs of a time in seconds and a factor, or a function from the time to the factor, asked 24 times a second for the first minute. In `settle` it has no say.
---@field follows? boolean # True when it moves with the head. [default false]
---@field name? string # What messages and the debug view call it.

---An attractor: hair farther than `radius` from the centre is drawn to it, the more the farther. It ties bundles.
---@param fields coif.force.attractor.fields
---@return coif.Force
function coif.force.attractor(fields) end

---What `coif.force.repeller` takes.
---@class (exact) coif.force.repeller.fields
---@field centre coif.Point # The point it drives away from. [cm]
---@field core? number # Within this distance it weakens towards the centre, where it has no direction. [cm; 0.01 to 1000; default 1]
---@field strength? number # Acceleration at 10 cm from the centre. [cm/s^2; 0 to 1000000; default 1000]
---@field fall_off? "constant"|"proportional"|"inverse" # How it changes with the distance. [default "inverse"]
---@field zone? coif.Box|coif.Ball # The box or ball that it acts in; everywhere when left out.
---@field edge? number # The way inside the zone's border over which it fades out; 0 ends at the border. [cm; 0 to 1000; default 0]
---@field over_time? { number, number }[] | fun(time: number): number # Factors on the strength: pairs of a time in seconds and a factor, or a function from the time to the factor, asked 24 times a second for the first minute. In `settle` it has no say.
---@field follows? boolean # True when it moves with the head. [default false]
---@field name? string # What messages and the debug view call it.

---A repeller: hair is driven away from the centre, the less the farther. It keeps bundles fluffy.
---@param fields coif.force.repeller.fields
---@return coif.Force
function coif.force.repeller(fields) end

---What `coif.force.vortex` takes.
---@class (exact) coif.force.vortex.fields
---@field centre coif.Point # A point on the axis. [cm]
---@field axis? coif.Direction # The axis; seen against its direction it turns anticlockwise. [default { 0, 1, 0 }]
---@field core? number # Within this distance from the axis it weakens towards it. [cm; 0.01 to 1000; default 1]
---@field strength? number # Acceleration at 10 cm from the axis. [cm/s^2; 0 to 1000000; default 1000]
---@field fall_off? "constant"|"proportional"|"inverse" # How it changes with the distance from the axis. [default "inverse"]
---@field zone? coif.Box|coif.Ball # The box or ball that it acts in; everywhere when left out.
---@field edge? number # The way inside the zone's border over which it fades out; 0 ends at the border. [cm; 0 to 1000; default 0]
---@field over_time? { number, number }[] | fun(time: number): number # Factors on the strength: pairs of a time in seconds and a factor, or a function from the time to the factor, asked 24 times a second for the first minute. In `settle` it has no say.
---@field follows? boolean # True when it moves with the head. [default false]
---@field name? string # What messages and the debug view call it.

---A vortex: hair is swept around an axis. With an attractor on the axis it makes big curls.
---@param fields coif.force.vortex.fields
---@return coif.Force
function coif.force.vortex(fields) end

---An elliptic tuft instead of a round one; then `diameter` and `peak` do nothing.
---@class (exact) coif.tuft.ellipse
---@field horizontal number # Greatest radius across, along the head. [cm; 0.05 to 20]
---@field vertical number # Greatest radius through, away from the head. [cm; 0.05 to 20]
---@field alpha? number # Opens the root: 0 starts in a point. [0 to 10; default 0]
---@field beta? number # Opens the tip: 0 ends in a point. [0 to 10; default 0]

---What `coif.tuft` takes.
---@class (exact) coif.tuft.fields
---@field stroke (coif.Point|coif.Head.point.fields)[] # Control points that the stroke runs through, the first on the head, in head space.
---@field diameter? number # Greatest diameter. [mm; 1 to 100; default 30]
---@field peak? number # Where along the stroke the greatest diameter is. [%; 1 to 100; default 30]
---@field ellipse? coif.tuft.ellipse # An elliptic tuft instead of a round one; then `diameter` and `peak` do nothing.
---@field profile? coif.Point[]|fun(t: number): number, number? # Sizes along the stroke instead of a round tuft: { place 0 to 1, width, thickness } each, in cm.
---@field flatten? number # 0 leaves the thickness as it is, towards 1 makes the tuft flat. [0 to 0.95; default 0]
---@field twist? number # Turn about the stroke from root to tip. [degrees; -3600 to 3600; default 0]
---@field bend? number # Bends the width into an arc of this angle, edges towards the head. [degrees; -330 to 330; default 0]
---@field tips? number # Number of tips. [whole; 1 to 8; default 1]
---@field split? number # How much of the stroke the tips are apart. [0.05 to 0.9; default 0.3]
---@field spread? number # How far the tips spread: 0 go side by side, 1 end twice as far apart. [-0.9 to 10; default 0.5]
---@field up? coif.Direction # Where the thickness points; away from the head when left out.
---@field plane? coif.Direction # Keeps the stroke in the plane through its root with this normal.
---@field depth? number # How deep the start is buried in the head. [cm; 0.05 to 10; default 1]
---@field tolerance? number # Greatest distance of the mesh from the true surface. [cm; 0.001 to 10; default 0.05]
---@field rings? number # Number of rings along the stroke instead of `tolerance`; needs `sides`. [whole; 1 to 1000]
---@field sides? number # Number of vertices around the tuft instead of `tolerance`; alone, rings stand at the control points. [whole; 3 to 400]
---@field bury? boolean # Lets the tuft run through the head without a warning. [default false]
---@field head? coif.Head # The head it grows on; needed only when the script made several.
---@field material? coif.TuftMaterial|coif.material.tuft.fields|coif.Colour # Its look: `coif.material.tuft { ... }`, its fields, or a colour as "#6b432b".
---@field lift? boolean # Moves control points outward where the tuft would run through the head. [default false]
---@field dip? number # How deep it may lie in the head without a warning, as a fraction of its thickness there. [0 to 1; default 0.5]

---A tuft of stylised hair along a stroke.
---@param fields coif.tuft.fields
---@return coif.Tufts
function coif.tuft(fields) end

---What `coif.fill` takes.
---@class (exact) coif.fill.fields
---@field around? number # Density from tuft to tuft. [1 to 100; default 50]
---@field up? number # Density of rows towards the crown; none when left out. [1 to 100]
---@field down? number # Density of rows towards the neck; none when left out. [1 to 100]
---@field jitter? number # How far roots are strewn: 1 is up to 9 degrees in azimuth and elevation. [0 to 1; default 0]
---@field seed? number # Another number strews the roots otherwise. [whole; default 0]
---@field everywhere? boolean # Also where hair does not grow: on the face and low on the neck. [default false]
---@field [integer] coif.Tufts # The tufts to fill between, in order, each with the same number of control points. From each to the next the fill goes about the head from left over back to right; a single tuft, or the same one twice, goes all the way around. They are part of the result.
---@field lift? boolean # Moves control points outward where a tuft would run through the head. [default false]
---@field dip? number # How deep a tuft may lie in the head without a warning, as a fraction of its thickness there. [0 to 1; default 0.5]

---More tufts between given ones: around the head, and in rows towards crown and neck.
---@param fields coif.fill.fields
---@return coif.Tufts
function coif.fill(fields) end

---What `coif.material.tuft` takes.
---@class (exact) coif.material.tuft.fields
---@field colour? coif.Colour # Colour in the light. [default "#6b432b"]
---@field tip_colour? coif.Colour # Colour towards the tip; `colour` when left out.
---@field shade? coif.Colour # Colour in the shade, of toon shading; a darker `colour` when left out.
---@field light? coif.Colour # Colour of the band of light, of toon shading; a lighter `colour` when left out.
---@field ink? coif.Colour # Colour of the outline, of toon shading; a very dark `colour` when left out.
---@field tones? number # Number of flat tones of toon shading: 2 for light and shade, 3 for a darker one in the depth too. [whole; 2 to 3; default 2]
---@field shine? number # Width and strength of the light: 0 none, 1 much. [0 to 1; default 0.5]
---@field roughness? number # 0 mirror to 1 chalk, of soft shading and exported files. [0 to 1; default 0.5]

---How stylised hair looks: its colours and its band of light.
---@param fields? coif.material.tuft.fields
---@return coif.TuftMaterial
function coif.material.tuft(fields) end

---What `coif.cap` takes.
---@class (exact) coif.cap.fields
---@field border? (coif.Point|coif.Head.point.fields)[] # Control points of the border on the head, in order around it; the natural hairline when left out.
---@field crown? coif.Point # Where the hair parts to all sides; the top of the head when left out.
---@field thickness? number # Thickness of the hair on the head. [cm; 0.02 to 5; default 0.5]
---@field rim? number # Over how much of the way from the border to the crown the thickness grows. [0.01 to 1; default 0.25]
---@field refine? number # Rounds of halving each triangle; the method's own number is 2. [whole; 1 to 6; default 4]
---@field smooth? boolean # Rounds the border off; a polygon between the control points when false. [default true]
---@field head? coif.Head # The head it belongs to; needed only when the script made several.
---@field material? coif.TuftMaterial|coif.material.tuft.fields|coif.Colour # Its look: `coif.material.tuft { ... }`, its fields, or a colour as "#6b432b".

---A cap of hair that lies on the scalp.
---@param fields? coif.cap.fields
---@return coif.Piece
function coif.cap(fields) end

---What `coif.bun` takes.
---@class (exact) coif.bun.fields
---@field position coif.Point # Its middle.
---@field axis? coif.Direction # From the head outward through its middle. [default { 0, 1, 0 }]
---@field radius? number # Radius across the axis. [cm; 0.1 to 30; default 3]
---@field length? number # Length along the axis; as long as wide when left out. [cm; 0.1 to 60]
---@field grooves? number # Number of grooves; 0 for a smooth bun. [whole; 0 to 60; default 0]
---@field groove_depth? number # Depth of the grooves as a fraction of the radius. [0 to 0.5; default 0.18]
---@field swirl? number # How far the grooves wind about the axis from pole to pole. [degrees; -3600 to 3600; default 120]
---@field tolerance? number # Greatest distance of the mesh from the true surface. [cm; 0.001 to 5; default 0.03]
---@field head? coif.Head # The head it belongs to; needed only when the script made several.
---@field material? coif.TuftMaterial|coif.material.tuft.fields|coif.Colour # Its look: `coif.material.tuft { ... }`, its fields, or a colour as "#6b432b".

---A bun: a closed ball of hair, with grooves where its locks lie side by side.
---@param fields coif.bun.fields
---@return coif.Piece
function coif.bun(fields) end

---What `coif.ring` takes.
---@class (exact) coif.ring.fields
---@field at number # Place along the stroke: 0 root, 1 tip. [0 to 1]
---@field width? number # Length along the stroke. [cm; 0.02 to 20; default 0.8]
---@field thickness? number # How far it stands off the lock. [cm; 0.01 to 5; default 0.25]
---@field shape? "round"|"flat" # A round cord or a flat ribbon. [default "round"]
---@field sides? number # Vertices around the lock. [whole; 3 to 400; default 32]
---@field [integer] coif.Tufts # The tufts to put a ring around, each its own.
---@field material? coif.TuftMaterial|coif.material.tuft.fields|coif.Colour # Its look: `coif.material.tuft { ... }`, its fields, or a colour as "#6b432b".

---A ring or ribbon around a lock.
---@param fields coif.ring.fields
---@return coif.Piece
function coif.ring(fields) end

---What `coif.mesh` takes.
---@class (exact) coif.mesh.fields
---@field file string # The file, beside the script or below its folder.
---@field unit? "mm"|"cm"|"dm"|"m"|"in"|"ft" # What one unit of the file is; metres for glTF, centimetres for OBJ when left out.
---@field up? "x"|"y"|"z"|"-x"|"-y"|"-z" # The axis of the file that points up; "y" when left out.
---@field forward? "x"|"y"|"z"|"-x"|"-y"|"-z" # The axis of the file that points to the front; "z", or "-y" when z is up.
---@field groups? string[] # Only these groups, objects or materials; everything when left out.
---@field at? coif.Point # How far it is moved. [cm; default { 0, 0, 0 }]
---@field head? coif.Head # The head it belongs to; needed only when the script made several.
---@field material? coif.TuftMaterial|coif.material.tuft.fields|coif.Colour # Its look: `coif.material.tuft { ... }`, its fields, or a colour as "#6b432b".

---Stylised hair from a file: OBJ, glTF or GLB. It stays where it is in the file, but for `at`. Several files of
---one topology are the states of a lock that moves: `coif.animate { states = { rest, bent }, ... }`.
---@param fields coif.mesh.fields
---@return coif.Piece
function coif.mesh(fields) end

---What `coif.path` takes.
---@class (exact) coif.path.fields
---@field points? (coif.Point|coif.Head.point.fields)[] # Places that the handle passes, in head space. [cm]
---@field offsets? coif.Point[] # The same as seen from where the handle is at rest, so that one path does for many locks. [cm]
---@field states? integer[] # The same as numbers of states: the handle passes where it is in each; 1 is the rest.
---@field frames? number # How many frames it takes. [whole; 1 to 100000; default 40]
---@field curve? "spline"|"line" # What joins the points. [default "spline"]
---@field ease? "smooth"|"linear"|"in"|"out"|"hold" # How speed changes on the way; with `times`, from each point to the next. [default "linear"]
---@field times? number[] # When each point is passed, rising, in any unit: the first is the first frame, the last the last. Without them speed is even but for `ease`. A closed path has one more, for the way back to its first point.
---@field closed? boolean # Leads from the last point on to the first. [default false]
---@field back? boolean # Turns round at the last point and comes back the same way. [default false]

---A path for the handle of a lock. Give `points`, `offsets` or `states`.
---@param fields? coif.path.fields
---@return coif.Path
function coif.path(fields) end

---Vertices that follow paths.
---@class (exact) coif.animate.handles
---@field at? "tip"|number|coif.Point # Which vertex: "tip", a number from 0 (root) to 1 (tip) on the side away from the head, or the one nearest to a place. [default "tip"]
---@field path coif.Path # The way it goes.
---@field lock? number # Only on the lock of this number; on all of them when left out. [whole; 1 to 1000000]

---Lets the handles trail behind the head's motion, as hair does: `{}`, or how.
---@class (exact) coif.animate.lag
---@field hold? number # How well the hair keeps its shape, as in `strands:simulate`: more is stiffer and swings faster. [cm; 0 to 1000; default 8]
---@field drag? number # How strongly the air brakes it: more dies sooner. [1/s; 0 to 1000; default 3]
---@field amount? number # How much of the lag is shown. [0 to 2; default 1]

---What `coif.animate` takes.
---@class (exact) coif.animate.fields
---@field states (coif.Tufts|coif.Piece)[] # The rest, and the same locks posed in other ways: all tufts with the same number of locks, or all pieces of one mesh. The rings and sides of tufts are made the same; the rest's look counts.
---@field path? coif.Path # The way of the tip of every lock; the same as one handle with `at = "tip"`.
---@field handles? coif.animate.handles[] # Vertices that follow paths.
---@field held? "root"|number|fun(place: vector, along: number): boolean # What stays: "root", everything up to a part of the way from root (0) to tip (1), or a function that is asked about every vertex: its place, and how far along it is. [default "root"]
---@field rate? number # Frames in a second; that of `motion` when left out, or 24. [1/s; 1 to 240]
---@field loop? boolean # The first frame follows the last; paths must then end where they began, by `closed` or `back`. [default false]
---@field stagger? number # Each lock begins so much later than the one before it. [s; -100 to 100; default 0]
---@field motion? coif.Motion # What the head does meanwhile: the locks are carried along.
---@field lag? coif.animate.lag # Lets the handles trail behind the head's motion, as hair does: `{}`, or how.

---Locks that move: posed states, and paths for their handles. The whole surface follows in the way the states
---show.
---@param fields coif.animate.fields
---@return coif.LocksClip
function coif.animate(fields) end

---What `coif.lattice` takes.
---@class (exact) coif.lattice.fields
---@field around? coif.Garment|coif.Strands|coif.Tufts|coif.Piece|coif.Head|coif.Box|nil # What it goes around: a garment, hair, a head, or a box.
---@field margin? number # How much larger it is than that. [cm; 0 to 100; default 0.5]
---@field corner? coif.Point # A corner, instead of `around`. [cm]
---@field edges? coif.Point[] # The three edges from that corner, right-handed.
---@field divisions? number[] # Into how many pieces each edge is divided: control points go from 0 to these. [default { 4, 4, 4 }]

---A lattice of control points: a box around what is to be moved, or any parallelepiped.
---@param fields? coif.lattice.fields
---@return coif.Lattice
function coif.lattice(fields) end

---The points: `{ at = { 0, 0, 0 } }` stays, `{ at = { 0, 0, 5 }, to = { 0, 1, 6 } }` is moved.
---@class (exact) coif.pins.points
---@field at coif.Point # Where it is. [cm]
---@field to? coif.Point # Where it goes. [cm]
---@field name? string # A name, to mark it by later.
---@field kind? "overall"|"feature"|"fixed" # What it is for; `feature` with a target and `fixed` without one when left out. Any other kind without a target rides along.

---What `coif.pins` takes.
---@class (exact) coif.pins.fields
---@field [integer] coif.pins.points # The points: `{ at = { 0, 0, 0 } }` stays, `{ at = { 0, 0, 5 }, to = { 0, 1, 6 } }` is moved.
---@field power? number # How much more a near point counts than a far one: the exponent of the affinity. [0.5 to 8; default 2]

---Fixed points and operated points: every operated point lands on its target, no fixed point moves, and between
---them each place follows those that are near.
---@param fields coif.pins.fields
---@return coif.Pins
function coif.pins(fields) end

---Four control points or more, at most 500, on all sides of their middle.
---@class (exact) coif.cage.points
---@field at coif.Point # Where it is. [cm]
---@field to? coif.Point # Where it goes. [cm]
---@field name? string # A name, to move it by.
---@field kind? "overall"|"feature"|"fixed" # What it is for; `feature` with a target and `overall` without one when left out.

---What `coif.cage` takes.
---@class (exact) coif.cage.fields
---@field [integer] coif.cage.points # Four control points or more, at most 500, on all sides of their middle.
---@field around? coif.Garment|coif.Strands|coif.Tufts|coif.Piece|coif.Head|coif.Box|nil # Instead: what a cage is made around. It is a box with divided sides that is drawn in to it.
---@field divisions? number # Of a cage that is made around something: into how many pieces each edge of the box is divided. [whole; 1 to 8; default 2]
---@field margin? number # Of a cage that is made around something: how far off it is. [cm; 0 to 100; default 1]
---@field mesh? coif.Garment # Instead: a closed mesh of at most 500 vertices, as loaded with `coif.garment.load`.

---A cage of scattered control points, without a grid: what is inside follows them, what is outside stays. The
---points are given (`{ at = place, to = place, name = "chin" }`, on all sides of what moves), or made around
---something, or they are the vertices of a closed mesh.
---@param fields? coif.cage.fields
---@return coif.Cage
function coif.cage(fields) end

---Four points or more that do not lie in a plane, as of `coif.pins`.
---@class (exact) coif.warp.points
---@field at coif.Point # Where it is. [cm]
---@field to? coif.Point # Where it goes. [cm]
---@field name? string # A name, to mark it by later.
---@field kind? "overall"|"feature"|"fixed" # What it is for; `feature` with a target and `fixed` without one when left out. Any other kind without a target rides along.

---What `coif.warp` takes.
---@class (exact) coif.warp.fields
---@field [integer] coif.warp.points # Four points or more that do not lie in a plane, as of `coif.pins`.

---A smooth motion of all space through scattered points: a point with a target goes there, one without stays. It
---has no border, and far away it goes on; so give points that stay on the other side too.
---@param fields coif.warp.fields
---@return coif.Warp
function coif.warp(fields) end

---What `coif.garment.skirt` takes.
---@class (exact) coif.garment.skirt.fields
---@field waist? number # Girth of the waistband. [cm; 30 to 200; default 57]
---@field hip? number # Girth around the hip. [cm; 40 to 250; default 88]
---@field hem? number # Girth of the hem, as a tape around its folds reads it. [cm; 40 to 800; default 170]
---@field length? number # From the waist to the hem. [cm; 15 to 110; default 58]
---@field folds? number # How many folds; 0 for none. [whole; 0 to 60; default 13]
---@field fold_depth? number # How deep the folds are at the hem. [cm; 0 to 20; default 3.2]
---@field colour? coif.Colour # Its colour. [default "#6f83a8"]
---@field roughness? number # 0 mirror to 1 chalk. [0 to 1; default 0.85]

---A skirt with a waistband.
---@param fields? coif.garment.skirt.fields
---@return coif.Garment
function coif.garment.skirt(fields) end

---What `coif.garment.dress` takes.
---@class (exact) coif.garment.dress.fields
---@field bust? number # Girth around the bust. [cm; 50 to 200; default 84]
---@field waist? number # Girth around the waist. [cm; 40 to 200; default 57]
---@field hip? number # Girth around the hip. [cm; 50 to 250; default 90]
---@field hem? number # Girth of the hem, as a tape around its folds reads it. [cm; 50 to 800; default 210]
---@field length? number # From the waist to the hem. [cm; 20 to 98; default 56]
---@field folds? number # How many folds; 0 for none. [whole; 0 to 60; default 14]
---@field fold_depth? number # How deep the folds are at the hem. [cm; 0 to 20; default 3.5]
---@field neckline? number # How low the neckline is cut in front. [cm; 0 to 16; default 8]
---@field colour? coif.Colour # Its colour. [default "#6f83a8"]
---@field roughness? number # 0 mirror to 1 chalk. [0 to 1; default 0.85]

---A sleeveless dress: a close bodice, and a skirt that falls in folds.
---@param fields? coif.garment.dress.fields
---@return coif.Garment
function coif.garment.dress(fields) end

---What `coif.garment.shirt` takes.
---@class (exact) coif.garment.shirt.fields
---@field bust? number # Girth around the bust. [cm; 50 to 200; default 88]
---@field waist? number # Girth around the waist. [cm; 40 to 200; default 66]
---@field hip? number # Girth around the hip. [cm; 50 to 200; default 92]
---@field length? number # From the neck to the hem. [cm; 40 to 90; default 63]
---@field sleeves? number # Length of the sleeves; 0 leaves them out. [cm; 0 to 62; default 24]
---@field spread? number # How far the sleeves stand off the body. [degrees; 15 to 85; default 38]
---@field neckline? number # How low the neckline is cut in front. [cm; 0 to 16; default 4.5]
---@field colour? coif.Colour # Its colour. [default "#6f83a8"]
---@field roughness? number # 0 mirror to 1 chalk. [0 to 1; default 0.85]

---A shirt with sleeves.
---@param fields? coif.garment.shirt.fields
---@return coif.Garment
function coif.garment.shirt(fields) end

---What `coif.garment.trousers` takes.
---@class (exact) coif.garment.trousers.fields
---@field waist? number # Girth of the waistband. [cm; 40 to 200; default 62]
---@field hip? number # Girth around the hip. [cm; 50 to 200; default 92]
---@field hem? number # Girth of a leg at its hem. [cm; 20 to 120; default 38]
---@field knee? number # Girth of a leg at the knee. [cm; 25 to 120; default 42]
---@field length? number # From the waist to the hem. [cm; 38 to 105; default 96]
---@field colour? coif.Colour # Its colour. [default "#6f83a8"]
---@field roughness? number # 0 mirror to 1 chalk. [0 to 1; default 0.85]

---Trousers with a waistband.
---@param fields? coif.garment.trousers.fields
---@return coif.Garment
function coif.garment.trousers(fields) end

---What `coif.garment.form` takes.
---@class (exact) coif.garment.form.fields
---@field bust? number # Girth around the bust. [cm; 50 to 200; default 84]
---@field waist? number # Girth around the waist. [cm; 35 to 200; default 60]
---@field hip? number # Girth around the hip. [cm; 50 to 200; default 88]
---@field stand? boolean # False leaves the stand out. [default true]
---@field colour? coif.Colour # Its colour. [default "#6f83a8"]
---@field roughness? number # 0 mirror to 1 chalk. [0 to 1; default 0.85]

---A dress form: a woman's torso, closed, on a stand.
---@param fields? coif.garment.form.fields
---@return coif.Garment
function coif.garment.form(fields) end

---What `coif.garment.load` takes.
---@class (exact) coif.garment.load.fields
---@field file string # The file, beside the script or below its folder.
---@field unit? "mm"|"cm"|"dm"|"m"|"in"|"ft" # What one unit of the file is; metres for glTF, centimetres for OBJ when left out.
---@field up? "x"|"y"|"z"|"-x"|"-y"|"-z" # The axis of the file that points up; "y" when left out.
---@field forward? "x"|"y"|"z"|"-x"|"-y"|"-z" # The axis of the file that points to the front; "z", or "-y" when z is up.
---@field groups? string[] # Only these groups, objects or materials; everything when left out.
---@field at? coif.Point # How far it is moved. [cm; default { 0, 0, 0 }]
---@field colour? coif.Colour # Its colour. [default "#6f83a8"]
---@field roughness? number # 0 mirror to 1 chalk. [0 to 1; default 0.85]

---A garment, or any other mesh, from a file: OBJ, glTF or GLB. Its groups, objects and materials are its parts. It
---stays where it is in the file, but for `at`.
---@param fields coif.garment.load.fields
---@return coif.Garment
function coif.garment.load(fields) end

---What `coif.material.hair` takes.
---@class (exact) coif.material.hair.fields
---@field root_colour? coif.Colour # Colour at the root. [default "#2e1b12"]
---@field tip_colour? coif.Colour # Colour at the tip. [default "#6b432b"]
---@field variation? number # How far single strands differ in brightness: 0 all alike, 1 from black to white. [0 to 1; default 0.15]
---@field width? number # Diameter at the root; real hair has 0.006 to 0.01, a preview with fewer strands wants more. [cm; 0.0005 to 1; default 0.02]
---@field taper? number # Diameter at the tip as a fraction of `width`. [0 to 1; default 0.3]
---@field shine? number # Strength of the highlight: 0 dull, 1 glossy. [0 to 1; default 0.5]
---@field roughness? number # Width of the highlight: 0 a thin line, 1 broad and soft. [0 to 1; default 0.4]

---How hair looks: colours, width, shine.
---@param fields? coif.material.hair.fields
---@return coif.HairMaterial
function coif.material.hair(fields) end

---What `coif.clip` takes.
---@class (exact) coif.clip.fields
---@field [integer] coif.Strands # The poses, two or more: strands of the same roots with the same numbers of nodes. The first is the rest.
---@field seconds? number # Time from each pose to the next. [s; 0.01 to 3600; default 1]
---@field rate? number # Frames in a second. [1/s; 1 to 240; default 24]
---@field ease? "smooth"|"linear"|"in"|"out"|"hold" # How each pose is left and come to. [default "smooth"]
---@field loop? boolean # True to go back from the last pose to the first, over and over. [default false]
---@field margin? number # Least distance of hair from the skin. [cm; 0.005 to 10; default 0.05]

---Strands on their way through poses: the same strands, styled in different ways. Strands bend from pose to pose
---and keep their length.
---@param fields coif.clip.fields
---@return coif.StrandsClip
function coif.clip(fields) end

---What `coif.scene` takes.
---@class (exact) coif.scene.fields
---@field [integer] any # The head and the hair, in any number and order; lists in the list are taken apart.
---@field views? ("front"|"back"|"left"|"right"|"top"|"three-quarter"|"back-three-quarter")[] # The views of the preview, in order. [default { "front", "left", "back" }]
---@field background? "white"|"dark" # The colour behind everything. [default "white"]
---@field shading? "soft"|"toon" # How surfaces and light are drawn. [default "soft"]
---@field skin? coif.Colour # Colour of the head. [default "#d9b8a3"]
---@field motion? coif.Motion # How the head moves: `head:motion { ... }`. What is on it moves with it, but for hair whose own motion was made with this one; when there is such hair, this may be left out.
---@field still? number # Of a scene that moves, the frame of still pictures, from 1; the middle one when left out. [whole; 1 to 1000000000]
---@field strip? number[] # Of a scene that moves, the frames of the strip, from 1; eight of them, evenly, when left out.

---Puts together what the pictures and files show. A script ends with `return coif.scene { head, hair }`.
---@param fields? coif.scene.fields
---@return coif.Scene
function coif.scene(fields) end

---Declares a test; it is run by `coif test`, in a fresh state of its own.
---@param name string # What it shows, in a few words; unique within the file.
---@param body fun(t: coif.Test) # Takes the Test, `t`, whose methods run styles and state what is expected.
function coif.test(name, body) end

---A head in head space: its origin lies between the ears, x points to its left, y up, z to the front, in cm.
---@class coif.Head
---@field scale number # Height from chin to vertex over an adult's 23 cm; offsets are multiplied by it.
---@field name string # What it is called: `mannequin`, or its file.
---@field centre vector # The middle of the skull.
local Head = {}

---A landmark plus an offset in cm (to the head's left, up, to the front) that grows with the head.
---@param landmark "vertex"|"forehead"|"left_temple"|"right_temple"|"left_ear"|"right_ear"|"occiput"|"nape"|"chin" # `vertex`, `forehead`, `left_temple`, `right_temple`, `left_ear`, `right_ear`, `occiput`, `nape`, `chin`.
---@param offset? coif.Point # From there, for an adult's head. [cm; default { 0, 0, 0 }]
---@return vector
function Head:at(landmark, offset) end

---A half of the space about the head, or all of it, as a box.
---@param name "all"|"behind"|"front"|"left"|"right"|"above"|"below" # `all`, `behind`, `front`, `left`, `right`, `above`, `below` the ears.
---@return coif.Box
function Head:box(name) end

---What `Head:point` takes.
---@class (exact) coif.Head.point.fields
---@field azimuth? number # From the face towards the head's left: 90 is the left ear, 180 the back. [degrees; -360 to 360; default 0]
---@field elevation? number # Upwards: 90 is the top. [degrees; -90 to 90; default 0]
---@field height? number # Over the skin, for an adult's head. [cm; -20 to 200; default 0]

---A place over the skin, in a direction from the middle of the skull.
---@param fields? coif.Head.point.fields
---@return vector
function Head:point(fields) end

---The place of the skin that is nearest to a point.
---@param point coif.Point # Any point. [cm]
---@return vector
function Head:skin(point) end

---The direction straight out of the skin, at the place nearest to a point.
---@param point coif.Point # Any point. [cm]
---@return vector
function Head:normal(point) end

---The natural scalp: where hair grows on a person.
---@return coif.Region
function Head:scalp() end

---What `Head:region` takes.
---@class (exact) coif.Head.region.fields
---@field [integer] coif.Point # Points of the curve, in order, three or more; they are laid on the head.
---@field smooth? boolean # False for straight edges. [default true]

---A region that a closed curve on the head encloses.
---@param fields coif.Head.region.fields
---@return coif.Region
function Head:region(fields) end

---A group, an object or a material of the head's file, as a region.
---@param name string # Its name.
---@return coif.Region
function Head:group(name) end

---A region from a picture over the head's texture coordinates: white grows hair, black none, grey less.
---@param file string # A PNG file, beside the script or below its folder.
---@return coif.Region
function Head:mask(file) end

---What `Head:parting` takes.
---@class (exact) coif.Head.parting.fields
---@field [integer] coif.Point # Points of the line, in order, two or more; they are laid on the skin.

---A parting: a line on the scalp that strands never blend across. Lay it through a region by `Region:parting`.
---@param fields coif.Head.parting.fields
---@return coif.Parting
function Head:parting(fields) end

---The poses, in the order of their times.
---@class (exact) coif.Head.motion.poses
---@field time number # When, from the motion's beginning. [s; 0 to 3600]
---@field yaw? number # Turned to the head's left. [degrees; -3600 to 3600; default 0]
---@field pitch? number # Nodded down. [degrees; -3600 to 3600; default 0]
---@field roll? number # Tilted to the head's left shoulder. [degrees; -3600 to 3600; default 0]
---@field shift? coif.Point # Moved, to the head's left, up, to the front. [cm; default { 0, 0, 0 }]
---@field ease? "smooth"|"linear"|"in"|"out"|"hold" # How it is come to from the pose before. [default "smooth"]

---What `Head:motion` takes.
---@class (exact) coif.Head.motion.fields
---@field [integer] coif.Head.motion.poses # The poses, in the order of their times.
---@field rate? number # Frames in a second. [1/s; 1 to 240; default 24]
---@field loop? boolean # True when the motion begins anew after the last pose, which must then be as the first. [default false]
---@field pivot? coif.Point # What it turns about; the joint of the neck when left out. [cm]

---A motion of the head, by its poses at times: the head turns about the joint of its neck. In a scene (`motion`)
---everything on the head moves with it.
---@param fields coif.Head.motion.fields
---@return coif.Motion
function Head:motion(fields) end

---What `Head:deform` takes.
---@class (exact) coif.Head.deform.fields
---@field [integer] coif.Lattice|coif.Cage|coif.Pins|coif.Warp # Lattices, cages, pins and warps, in the order they act.

---Moves it by lattices, cages, pins and warps, one after the other.
---@param fields coif.Head.deform.fields
---@return coif.Head
function Head:deform(fields) end

---What `Head:bend` takes.
---@class (exact) coif.Head.bend.fields
---@field angle number # By how much at the far end. [degrees; -180 to 180]
---@field towards? coif.Direction # Which way the far end goes. [default { 0, 0, 1 }]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]

---Bends it, as a whole: what lies at the far end turns by the angle, in between by a part of it.
---@param fields coif.Head.bend.fields
---@return coif.Head
function Head:bend(fields) end

---What `Head:taper` takes.
---@class (exact) coif.Head.taper.fields
---@field width number # Width at the far end as a multiple of what it was: below 1 narrows, above 1 flares. [0.01 to 10]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field about? coif.Point # The axis that it narrows towards goes through this place; the middle when left out. [cm]

---Makes it narrower, or wider (flared), towards the far end.
---@param fields coif.Head.taper.fields
---@return coif.Head
function Head:taper(fields) end

---What `Head:lift` takes.
---@class (exact) coif.Head.lift.fields
---@field by number # How far at the far end. [cm; -100 to 100]
---@field towards? coif.Direction # Which way. [default { 0, 1, 0 }]
---@field along? coif.Direction # From the near end to the far end; as `towards` when left out.
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]

---Lifts it: what lies at the far end is moved by the whole distance, what lies at the near end stays.
---@param fields coif.Head.lift.fields
---@return coif.Head
function Head:lift(fields) end

---A line on the scalp that strands never blend across.
---@class coif.Parting
local Parting = {}

---Tells the side of a parting: 1 on the head's left of a parting that runs from the forehead backward, -1 on its
---right, 0 on it.
---@param point coif.Point # Any point. [cm]
---@return number
function Parting:side(point) end

---A part of a head's surface, with a density.
---@class coif.Region
---@field area number # Its area in square centimetres, each place weighted with its density.
---@operator add(coif.Region): coif.Region
---@operator sub(coif.Region): coif.Region
---@operator mul(coif.Region): coif.Region
local Region = {}

---What `Region:guides` takes.
---@class (exact) coif.Region.guides.fields
---@field count? number # How many. [whole; 1 or more; default 800]
---@field length? number # The longest strand's length. [cm; 0.05 to 1000; default 25]
---@field length_variation? number # How much shorter strands may be, as a part of the length: 0 all alike, 1 down to nothing. [0 to 1; default 0.1]
---@field step? number # Length of a growth step. [cm; 0.01 to 100; default 0.5]
---@field stiffness? number # Resistance to bending: weight of the last tangent against the force. [0 to 10000; default 3]
---@field limit? number # Greatest number of growth steps; as many as the length needs when left out. [whole; 1 to 1000000]
---@field lay? coif.Direction # Where to strands lie from the first, along the skin.
---@field lay_from? coif.Point # Strands lie away from this point from the first: a whorl. With `lay` both act. [cm]
---@field lay_amount? number # How flat they lie: 0 stands upright on the skin, 1 lies on it; counts with `lay` or `lay_from`. [0 to 1; default 0.7]
---@field noise? number # Standard deviation of the gaussian noise on the first direction. [0 to 10; default 0]
---@field seed? number # Another seed gives other random numbers. [whole; default 0]
---@field density? number # Guides per square centimetre, instead of `count`. [1/cm^2; 0.0001 to 10000]

---Guides: the strands that are grown through the domains, each standing for one wisp.
---@param fields? coif.Region.guides.fields
---@return coif.Guides
function Region:guides(fields) end

---What is in either of two regions; also written `a + b`.
---@param other coif.Region # The other region, of the same head.
---@return coif.Region
function Region:union(other) end

---What is in both of two regions; also written `a * b`.
---@param other coif.Region # The other region, of the same head.
---@return coif.Region
function Region:intersect(other) end

---What is in this region and not in another; also written `a - b`.
---@param other coif.Region # The other region, of the same head.
---@return coif.Region
function Region:minus(other) end

---The rest of the head.
---@return coif.Region
function Region:complement() end

---The part of the region for whose places a function returns true.
---@param test fun(place: vector): boolean # Takes a place on the head (a vector), returns true or false.
---@return coif.Region
function Region:where(test) end

---The same region with hair thinned out.
---@param density number|fun(place: vector): number # A number from 0 to 1, or a function that takes a place on the head (a vector) and returns one.
---@return coif.Region
function Region:density(density) end

---The same region with a parting through it: strands on its two sides never blend.
---@param line coif.Parting|coif.Point[] # A parting, or a list of points to lay one through.
---@return coif.Region
function Region:parting(line) end

---Tells whether the place of the skin nearest to a point is in the region.
---@param point coif.Point # Any point. [cm]
---@return boolean
function Region:contains(point) end

---Roots of the strands that stand for wisps; `grow` makes strands of them.
---@class coif.Guides
---@field count number # How many.
---@field roots vector[] # Where they stand, as a list of vectors.
local Guides = {}

---Queues for some of the guides.
---@class (exact) coif.Guides.grow.locals
---@field where fun(root: vector): boolean # Takes a guide's root (a vector), returns true if the queue acts on that guide.
---@field queue coif.Queue # The queue.

---What `Guides:grow` takes.
---@class (exact) coif.Guides.grow.fields
---@field global? coif.Queue # The queue for all guides.
---@field locals? coif.Guides.grow.locals[] # Queues for some of the guides.
---@field margin? number # Least distance of hair from the skin. [cm; 0.005 to 10; default 0.05]

---Grows guides through queues of domains. The global queue acts on every guide; of the local queues the first one
---whose `where` is true for a guide's root acts on that guide too, at the same time and with equal rank.
---@param fields? coif.Guides.grow.fields
---@return coif.Strands
function Guides:grow(fields) end

---Strands of hair on a head.
---@class coif.Strands
---@field count number # How many strands.
local Strands = {}

---What `Strands:natural` takes.
---@class (exact) coif.Strands.natural.fields
---@field [integer] coif.Domain # The natural domains.
---@field where? fun(root: vector): boolean # Takes a strand's root (a vector), returns true for the strands to change; all when left out.
---@field margin? number # Least distance of hair from the skin. [cm; 0.005 to 10; default 0.05]
---@field seed? number # Another seed gives other random numbers. [whole; default 0]

---Lays waves and curls over strands. The domains form a queue of their own, by their priorities: each acts on the
---part of a strand inside its box, one stage after the other.
---@param fields coif.Strands.natural.fields
---@return coif.Strands
function Strands:natural(fields) end

---What `Strands:fill` takes.
---@class (exact) coif.Strands.fill.fields
---@field strands? number # How many strands. [whole; 1 or more; default 40000]
---@field nodes? number # Nodes per strand; when left out as many as the guides' bends need, at most as many as the guides have or 128. [whole; 2 to 4096]
---@field neighbours? number # How many guides a strand follows at most. [whole; 1 to 8; default 4]
---@field length_variation? number # How much shorter strands may be than their guides, as a part of the length. [0 to 1; default 0.05]
---@field noise? number # Standard deviation of the gaussian noise on the tangents, smooth along the strand. [0 to 10; default 0.02]
---@field flyaway? number # Part of the strands that stray, with six times the noise. [0 to 1; default 0]
---@field clump? number # How far strands gather round their guide: 0 leaves them evenly spread, 1 brings all tips to the guide's tip. [0 to 1; default 0]
---@field clump_start? number # Where along the strand gathering begins, as a part of the length. [0 to 0.95; default 0]
---@field thickness? number # Depth of the layer of hair over the guides. [cm; 0 to 20; default 0.4]
---@field margin? number # Least distance of hair from the skin. [cm; 0.005 to 10; default 0.03]
---@field seed? number # Another seed gives other random numbers. [whole; default 0]
---@field density? number # Strands per square centimetre, instead of `strands`. [1/cm^2; 0.0001 to 100000]
---@field region? coif.Region # Where to fill; where the guides grow when left out.
---@field material? coif.HairMaterial|coif.material.hair.fields # How the hair looks: `coif.material.hair { ... }`.

---Fills the scalp with strands between guides.
---@param fields? coif.Strands.fill.fields
---@return coif.Strands
function Strands:fill(fields) end

---The same strands with another look.
---@param material coif.HairMaterial|coif.material.hair.fields # `coif.material.hair { ... }`, or its fields.
---@return coif.Strands
function Strands:material(material) end

---Figures: `strands`, `points`, `guides`, `mean_length`, `longest`, `shortest` (cm), `inside` (strands with a node
---or a segment inside the head), `min` and `max` (corners of the bounding box).
---@return table<string, any>
function Strands:stats() end

---What `Strands:deform` takes.
---@class (exact) coif.Strands.deform.fields
---@field [integer] coif.Lattice|coif.Cage|coif.Pins|coif.Warp # Lattices, cages, pins and warps, in the order they act.
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Moves it by lattices, cages, pins and warps, one after the other.
---@param fields coif.Strands.deform.fields
---@return coif.Strands
function Strands:deform(fields) end

---What `Strands:bend` takes.
---@class (exact) coif.Strands.bend.fields
---@field angle number # By how much at the far end. [degrees; -180 to 180]
---@field towards? coif.Direction # Which way the far end goes. [default { 0, 0, 1 }]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Bends it, as a whole: what lies at the far end turns by the angle, in between by a part of it.
---@param fields coif.Strands.bend.fields
---@return coif.Strands
function Strands:bend(fields) end

---What `Strands:taper` takes.
---@class (exact) coif.Strands.taper.fields
---@field width number # Width at the far end as a multiple of what it was: below 1 narrows, above 1 flares. [0.01 to 10]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field about? coif.Point # The axis that it narrows towards goes through this place; the middle when left out. [cm]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Makes it narrower, or wider (flared), towards the far end.
---@param fields coif.Strands.taper.fields
---@return coif.Strands
function Strands:taper(fields) end

---What `Strands:lift` takes.
---@class (exact) coif.Strands.lift.fields
---@field by number # How far at the far end. [cm; -100 to 100]
---@field towards? coif.Direction # Which way. [default { 0, 1, 0 }]
---@field along? coif.Direction # From the near end to the far end; as `towards` when left out.
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Lifts it: what lies at the far end is moved by the whole distance, what lies at the near end stays.
---@param fields coif.Strands.lift.fields
---@return coif.Strands
function Strands:lift(fields) end

---What `Strands:carry` takes.
---@class (exact) coif.Strands.carry.fields
---@field to coif.Head # The other head.

---Carries it to another head: the smooth motion through the landmarks of both heads moves every point, roots are
---laid on the new skin, and what then lies in the new head is moved out.
---@param fields coif.Strands.carry.fields
---@return coif.Strands
function Strands:carry(fields) end

---What `Strands:settle` takes.
---@class (exact) coif.Strands.settle.fields
---@field limit? number # Simulated time after which it ends even if hair still moves. [s; 0.05 to 600; default 10]
---@field rest_speed? number # The speed below which hair is at rest. [cm/s; 0.001 to 100; default 0.5]
---@field forces? coif.Force[] # What acts on the hair; the earth's gravity when left out.
---@field drag? number # How strongly the air brakes hair: the part of its speed that it loses in a second, at first. 2 in `settle` and 3 in `simulate` when left out. [1/s; 0 to 1000]
---@field hold? number # How well hair keeps its shape: a strand of this length that sticks out level sags by a tenth of it under its own weight. Bare hair holds about 4 cm, with wax 10, with spray 20; 0 is limp. [cm; 0 to 1000; default 4]
---@field clamped? boolean # True when roots keep their direction; otherwise strands hang from their roots as from a hinge. [default true]
---@field collide? boolean # True when hair keeps out of the head. [default true]
---@field margin? number # Least distance of hair from the skin. [cm; 0.005 to 10; default 0.05]
---@field friction? number # How much hair sticks to the skin that it lies on: 0 slides freely. [0 to 10; default 0.3]
---@field repulsion? number # How strongly hair that is crowded spreads: the acceleration where it gets thinner to a third over one `spacing`. [cm/s^2; 0 to 100000; default 0]
---@field spacing? number # How near hair is crowded. [cm; 0.05 to 100; default 1]
---@field steps? number # Steps in a second of simulated time. [1/s; 24 to 100000; default 240]
---@field iterations? number # How often in a step segments are brought to their lengths. [whole; 1 to 100; default 2]
---@field lengths? "exact"|"root_free" # How far a segment is from its length: with a square root, or without. [default "exact"]
---@field solver? "chain"|"pairs" # How segments are brought to their lengths: all of a strand at once, or one after the other, which lets long strands stretch unless there are many `iterations`. [default "chain"]
---@field seed? number # Another seed gives other gusts. [whole; default 0]
---@field pinned? (coif.Box|coif.Ball)[] # Hair that lies in any of these at first is pinned to the head: a tie, a clasp.

---Lets hair move under forces until it is at rest.
---@param fields? coif.Strands.settle.fields
---@return coif.Strands
function Strands:settle(fields) end

---What `Strands:simulate` takes.
---@class (exact) coif.Strands.simulate.fields
---@field duration? number # How long; as long as the motion when left out, and 2 s without one. [s; 0.02 to 3600]
---@field rate? number # Frames in a second; as the motion when left out, and 24 without one. [1/s; 1 to 240]
---@field balanced? boolean # True when the shape at first is the one that gravity leaves hair in: it moves only as wind and the head move it. With false it is the shape without weight, and hair first falls. [default true]
---@field loop? boolean # True when the last frame goes over into the first; as the motion when left out.
---@field forces? coif.Force[] # What acts on the hair; the earth's gravity when left out.
---@field drag? number # How strongly the air brakes hair: the part of its speed that it loses in a second, at first. 2 in `settle` and 3 in `simulate` when left out. [1/s; 0 to 1000]
---@field hold? number # How well hair keeps its shape: a strand of this length that sticks out level sags by a tenth of it under its own weight. Bare hair holds about 4 cm, with wax 10, with spray 20; 0 is limp. [cm; 0 to 1000; default 4]
---@field clamped? boolean # True when roots keep their direction; otherwise strands hang from their roots as from a hinge. [default true]
---@field collide? boolean # True when hair keeps out of the head. [default true]
---@field margin? number # Least distance of hair from the skin. [cm; 0.005 to 10; default 0.05]
---@field friction? number # How much hair sticks to the skin that it lies on: 0 slides freely. [0 to 10; default 0.3]
---@field repulsion? number # How strongly hair that is crowded spreads: the acceleration where it gets thinner to a third over one `spacing`. [cm/s^2; 0 to 100000; default 0]
---@field spacing? number # How near hair is crowded. [cm; 0.05 to 100; default 1]
---@field steps? number # Steps in a second of simulated time. [1/s; 24 to 100000; default 240]
---@field iterations? number # How often in a step segments are brought to their lengths. [whole; 1 to 100; default 2]
---@field lengths? "exact"|"root_free" # How far a segment is from its length: with a square root, or without. [default "exact"]
---@field solver? "chain"|"pairs" # How segments are brought to their lengths: all of a strand at once, or one after the other, which lets long strands stretch unless there are many `iterations`. [default "chain"]
---@field seed? number # Another seed gives other gusts. [whole; default 0]
---@field pinned? (coif.Box|coif.Ball)[] # Hair that lies in any of these at first is pinned to the head: a tie, a clasp.
---@field motion? coif.Motion # What the head does meanwhile: `head:motion { ... }`.

---Lets hair move under forces, and keeps every frame.
---@param fields? coif.Strands.simulate.fields
---@return coif.StrandsClip
function Strands:simulate(fields) end

---Strands in motion: frames at equal distances in time. What takes strands takes them frame by frame.
---@class coif.StrandsClip
---@field count number # How many strands.
---@field frames number # How many frames.
---@field rate number # Frames in a second.
---@field seconds number # How long it lasts.
---@field loops boolean # True when the first frame follows the last.
local StrandsClip = {}

---The strands of one frame.
---@param frame number # Which frame, from 1; past the end a loop begins anew, anything else stands still. [whole; 1 to 1000000000]
---@return coif.Strands
function StrandsClip:frame(frame) end

---What `StrandsClip:natural` takes.
---@class (exact) coif.StrandsClip.natural.fields
---@field [integer] coif.Domain # The natural domains.
---@field where? fun(root: vector): boolean # Takes a strand's root (a vector), returns true for the strands to change; all when left out.
---@field margin? number # Least distance of hair from the skin. [cm; 0.005 to 10; default 0.05]
---@field seed? number # Another seed gives other random numbers. [whole; default 0]

---Lays waves and curls over strands in motion, as `Strands:natural` over strands. Each domain acts at every frame
---on the part of a strand that is inside its box at rest.
---@param fields coif.StrandsClip.natural.fields
---@return coif.StrandsClip
function StrandsClip:natural(fields) end

---What `StrandsClip:fill` takes.
---@class (exact) coif.StrandsClip.fill.fields
---@field strands? number # How many strands. [whole; 1 or more; default 40000]
---@field nodes? number # Nodes per strand; when left out as many as the guides' bends need, at most as many as the guides have or 128. [whole; 2 to 4096]
---@field neighbours? number # How many guides a strand follows at most. [whole; 1 to 8; default 4]
---@field length_variation? number # How much shorter strands may be than their guides, as a part of the length. [0 to 1; default 0.05]
---@field noise? number # Standard deviation of the gaussian noise on the tangents, smooth along the strand. [0 to 10; default 0.02]
---@field flyaway? number # Part of the strands that stray, with six times the noise. [0 to 1; default 0]
---@field clump? number # How far strands gather round their guide: 0 leaves them evenly spread, 1 brings all tips to the guide's tip. [0 to 1; default 0]
---@field clump_start? number # Where along the strand gathering begins, as a part of the length. [0 to 0.95; default 0]
---@field thickness? number # Depth of the layer of hair over the guides. [cm; 0 to 20; default 0.4]
---@field margin? number # Least distance of hair from the skin. [cm; 0.005 to 10; default 0.03]
---@field seed? number # Another seed gives other random numbers. [whole; default 0]
---@field density? number # Strands per square centimetre, instead of `strands`. [1/cm^2; 0.0001 to 100000]
---@field region? coif.Region # Where to fill; where the guides grow when left out.
---@field material? coif.HairMaterial|coif.material.hair.fields # How the hair looks: `coif.material.hair { ... }`.

---Fills the scalp with strands between guides in motion, as `Strands:fill` between guides. A strand follows the
---same guides by the same parts at every frame.
---@param fields? coif.StrandsClip.fill.fields
---@return coif.StrandsClip
function StrandsClip:fill(fields) end

---The same strands with another look.
---@param material coif.HairMaterial|coif.material.hair.fields # `coif.material.hair { ... }`, or its fields.
---@return coif.StrandsClip
function StrandsClip:material(material) end

---Figures: `frames`, `seconds`, `strands`, `points`, `guides`, `travel` (cm, the farthest that a node comes from
---where it is in the first frame), `stretch` (the greatest part by which a strand's length differs from that in
---the first frame), `min` and `max` (corners of the bounding box of all frames).
---@return table<string, any>
function StrandsClip:stats() end

---What `StrandsClip:deform` takes.
---@class (exact) coif.StrandsClip.deform.fields
---@field [integer] coif.Lattice|coif.Cage|coif.Pins|coif.Warp # Lattices, cages, pins and warps, in the order they act.
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Moves it by lattices, cages, pins and warps, one after the other.
---@param fields coif.StrandsClip.deform.fields
---@return coif.StrandsClip
function StrandsClip:deform(fields) end

---What `StrandsClip:bend` takes.
---@class (exact) coif.StrandsClip.bend.fields
---@field angle number # By how much at the far end. [degrees; -180 to 180]
---@field towards? coif.Direction # Which way the far end goes. [default { 0, 0, 1 }]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Bends it, as a whole: what lies at the far end turns by the angle, in between by a part of it.
---@param fields coif.StrandsClip.bend.fields
---@return coif.StrandsClip
function StrandsClip:bend(fields) end

---What `StrandsClip:taper` takes.
---@class (exact) coif.StrandsClip.taper.fields
---@field width number # Width at the far end as a multiple of what it was: below 1 narrows, above 1 flares. [0.01 to 10]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field about? coif.Point # The axis that it narrows towards goes through this place; the middle when left out. [cm]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Makes it narrower, or wider (flared), towards the far end.
---@param fields coif.StrandsClip.taper.fields
---@return coif.StrandsClip
function StrandsClip:taper(fields) end

---What `StrandsClip:lift` takes.
---@class (exact) coif.StrandsClip.lift.fields
---@field by number # How far at the far end. [cm; -100 to 100]
---@field towards? coif.Direction # Which way. [default { 0, 1, 0 }]
---@field along? coif.Direction # From the near end to the far end; as `towards` when left out.
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Lifts it: what lies at the far end is moved by the whole distance, what lies at the near end stays.
---@param fields coif.StrandsClip.lift.fields
---@return coif.StrandsClip
function StrandsClip:lift(fields) end

---What `StrandsClip:carry` takes.
---@class (exact) coif.StrandsClip.carry.fields
---@field to coif.Head # The other head.

---Carries it to another head: the smooth motion through the landmarks of both heads moves every point, roots are
---laid on the new skin, and what then lies in the new head is moved out.
---@param fields coif.StrandsClip.carry.fields
---@return coif.StrandsClip
function StrandsClip:carry(fields) end

---Stylised hair in motion: frames of its surface at equal distances in time.
---@class coif.LocksClip
---@field frames number # How many frames.
---@field rate number # Frames in a second.
---@field seconds number # How long it lasts.
---@field loops boolean # True when the first frame follows the last.
local LocksClip = {}

---What `LocksClip:deform` takes.
---@class (exact) coif.LocksClip.deform.fields
---@field [integer] coif.Lattice|coif.Cage|coif.Pins|coif.Warp # Lattices, cages, pins and warps, in the order they act.

---Moves it by lattices, cages, pins and warps, one after the other.
---@param fields coif.LocksClip.deform.fields
---@return coif.LocksClip
function LocksClip:deform(fields) end

---What `LocksClip:bend` takes.
---@class (exact) coif.LocksClip.bend.fields
---@field angle number # By how much at the far end. [degrees; -180 to 180]
---@field towards? coif.Direction # Which way the far end goes. [default { 0, 0, 1 }]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]

---Bends it, as a whole: what lies at the far end turns by the angle, in between by a part of it.
---@param fields coif.LocksClip.bend.fields
---@return coif.LocksClip
function LocksClip:bend(fields) end

---What `LocksClip:taper` takes.
---@class (exact) coif.LocksClip.taper.fields
---@field width number # Width at the far end as a multiple of what it was: below 1 narrows, above 1 flares. [0.01 to 10]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field about? coif.Point # The axis that it narrows towards goes through this place; the middle when left out. [cm]

---Makes it narrower, or wider (flared), towards the far end.
---@param fields coif.LocksClip.taper.fields
---@return coif.LocksClip
function LocksClip:taper(fields) end

---What `LocksClip:lift` takes.
---@class (exact) coif.LocksClip.lift.fields
---@field by number # How far at the far end. [cm; -100 to 100]
---@field towards? coif.Direction # Which way. [default { 0, 1, 0 }]
---@field along? coif.Direction # From the near end to the far end; as `towards` when left out.
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]

---Lifts it: what lies at the far end is moved by the whole distance, what lies at the near end stays.
---@param fields coif.LocksClip.lift.fields
---@return coif.LocksClip
function LocksClip:lift(fields) end

---What `LocksClip:carry` takes.
---@class (exact) coif.LocksClip.carry.fields
---@field to coif.Head # The other head.

---Carries it to another head: the smooth motion through the landmarks of both heads moves every point, roots are
---laid on the new skin, and what then lies in the new head is moved out.
---@param fields coif.LocksClip.carry.fields
---@return coif.LocksClip
function LocksClip:carry(fields) end

---A motion of the head; made by `Head:motion`.
---@class coif.Motion
---@field frames number # How many frames.
---@field rate number # Frames in a second.
---@field seconds number # How long it lasts.
---@field loops boolean # True when the first frame follows the last.
local Motion = {}

---Where a place of the head at rest is at a frame.
---@param point coif.Point # The place at rest. [cm]
---@param frame number # Which frame, from 1; past the end a loop begins anew, anything else stands still. [whole; 1 to 1000000000]
---@return vector
function Motion:place(point, frame) end

---A box, whose axes may be turned.
---@class coif.Box
---@field centre vector # Its middle.
---@field size vector # Its edge lengths.
local Box = {}

---Tells whether a point is inside the box.
---@param point coif.Point # Any point. [cm]
---@return boolean
function Box:contains(point) end

---A styling constraint with a region where it acts.
---@class coif.Domain
local Domain = {}

---Domains in stages; a stage acts when the one before it has let go.
---@class coif.Queue
local Queue = {}

---What moves hair in `settle` and `simulate`.
---@class coif.Force
local Force = {}

---A part of space.
---@class coif.Ball
local Ball = {}

---Locks of stylised hair on a head.
---@class coif.Tufts
---@field count number # How many tufts.
---@operator add(coif.Tufts): coif.Tufts
local Tufts = {}

---Both tufts and others of the same head; also written `a + b`. What is in both is there once.
---@param other coif.Tufts # The others.
---@return coif.Tufts
function Tufts:union(other) end

---All tufts on the head's other side.
---@return coif.Tufts
function Tufts:mirrored() end

---What `Tufts:rotated` takes.
---@class (exact) coif.Tufts.rotated.fields
---@field angle number # By how much. [degrees; -3600 to 3600]
---@field axis? coif.Direction # About which direction; straight out of the skin at the root when left out.

---Each tuft turned about its own root.
---@param fields coif.Tufts.rotated.fields
---@return coif.Tufts
function Tufts:rotated(fields) end

---What `Tufts:array` takes.
---@class (exact) coif.Tufts.array.fields
---@field count number # How many there are of each then. [whole; 1 to 1000]
---@field step number # From one to the next. [degrees; -360 to 360]
---@field axis? coif.Direction # The axis through the middle of the skull that they are turned about. [default { 0, 1, 0 }]

---Each tuft several times, set around the head with its roots on the skin.
---@param fields coif.Tufts.array.fields
---@return coif.Tufts
function Tufts:array(fields) end

---The same tufts with another look.
---@param material coif.TuftMaterial|coif.material.tuft.fields|coif.Colour # `coif.material.tuft { ... }`, its fields, or a colour.
---@return coif.Tufts
function Tufts:material(material) end

---Figures: `tufts`, `triangles`, `mean_length`, `longest`, `shortest` (cm along the stroke, with the buried
---start), `dips` (places that lie too deep in the head), `deepest` (cm, of these), `min` and `max` (corners of the
---bounding box).
---@return table<string, any>
function Tufts:stats() end

---What `Tufts:deform` takes.
---@class (exact) coif.Tufts.deform.fields
---@field [integer] coif.Lattice|coif.Cage|coif.Pins|coif.Warp # Lattices, cages, pins and warps, in the order they act.
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Moves it by lattices, cages, pins and warps, one after the other.
---@param fields coif.Tufts.deform.fields
---@return coif.Tufts
function Tufts:deform(fields) end

---What `Tufts:bend` takes.
---@class (exact) coif.Tufts.bend.fields
---@field angle number # By how much at the far end. [degrees; -180 to 180]
---@field towards? coif.Direction # Which way the far end goes. [default { 0, 0, 1 }]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Bends it, as a whole: what lies at the far end turns by the angle, in between by a part of it.
---@param fields coif.Tufts.bend.fields
---@return coif.Tufts
function Tufts:bend(fields) end

---What `Tufts:taper` takes.
---@class (exact) coif.Tufts.taper.fields
---@field width number # Width at the far end as a multiple of what it was: below 1 narrows, above 1 flares. [0.01 to 10]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field about? coif.Point # The axis that it narrows towards goes through this place; the middle when left out. [cm]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Makes it narrower, or wider (flared), towards the far end.
---@param fields coif.Tufts.taper.fields
---@return coif.Tufts
function Tufts:taper(fields) end

---What `Tufts:lift` takes.
---@class (exact) coif.Tufts.lift.fields
---@field by number # How far at the far end. [cm; -100 to 100]
---@field towards? coif.Direction # Which way. [default { 0, 1, 0 }]
---@field along? coif.Direction # From the near end to the far end; as `towards` when left out.
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field roots? number # Length along each strand, from its root, over which the motion comes in: roots stay on the head. With 0 they move as well. [cm; 0 to 100; default 3]
---@field where? fun(root: vector): boolean # Which of it: a function that takes a root (a vector) and returns true or false.
---@field margin? number # How far strands are kept from the skin. [cm; 0 to 2; default 0.1]

---Lifts it: what lies at the far end is moved by the whole distance, what lies at the near end stays.
---@param fields coif.Tufts.lift.fields
---@return coif.Tufts
function Tufts:lift(fields) end

---What `Tufts:carry` takes.
---@class (exact) coif.Tufts.carry.fields
---@field to coif.Head # The other head.

---Carries it to another head: the smooth motion through the landmarks of both heads moves every point, roots are
---laid on the new skin, and what then lies in the new head is moved out.
---@param fields coif.Tufts.carry.fields
---@return coif.Tufts
function Tufts:carry(fields) end

---How stylised hair looks; made by `coif.material.tuft`.
---@class coif.TuftMaterial
local TuftMaterial = {}

---The way of a handle; made by `coif.path`.
---@class coif.Path
---@field frames number # How many frames it takes.
local Path = {}

---A cap, a bun, a ring or a loaded mesh of stylised hair.
---@class coif.Piece
---@field kind string # `cap`, `bun`, `ring` or `mesh`.
---@field triangles number # How many triangles it has.
local Piece = {}

---What `Piece:deform` takes.
---@class (exact) coif.Piece.deform.fields
---@field [integer] coif.Lattice|coif.Cage|coif.Pins|coif.Warp # Lattices, cages, pins and warps, in the order they act.

---Moves it by lattices, cages, pins and warps, one after the other.
---@param fields coif.Piece.deform.fields
---@return coif.Piece
function Piece:deform(fields) end

---What `Piece:bend` takes.
---@class (exact) coif.Piece.bend.fields
---@field angle number # By how much at the far end. [degrees; -180 to 180]
---@field towards? coif.Direction # Which way the far end goes. [default { 0, 0, 1 }]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]

---Bends it, as a whole: what lies at the far end turns by the angle, in between by a part of it.
---@param fields coif.Piece.bend.fields
---@return coif.Piece
function Piece:bend(fields) end

---What `Piece:taper` takes.
---@class (exact) coif.Piece.taper.fields
---@field width number # Width at the far end as a multiple of what it was: below 1 narrows, above 1 flares. [0.01 to 10]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field about? coif.Point # The axis that it narrows towards goes through this place; the middle when left out. [cm]

---Makes it narrower, or wider (flared), towards the far end.
---@param fields coif.Piece.taper.fields
---@return coif.Piece
function Piece:taper(fields) end

---What `Piece:lift` takes.
---@class (exact) coif.Piece.lift.fields
---@field by number # How far at the far end. [cm; -100 to 100]
---@field towards? coif.Direction # Which way. [default { 0, 1, 0 }]
---@field along? coif.Direction # From the near end to the far end; as `towards` when left out.
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]

---Lifts it: what lies at the far end is moved by the whole distance, what lies at the near end stays.
---@param fields coif.Piece.lift.fields
---@return coif.Piece
function Piece:lift(fields) end

---What `Piece:carry` takes.
---@class (exact) coif.Piece.carry.fields
---@field to coif.Head # The other head.

---Carries it to another head: the smooth motion through the landmarks of both heads moves every point, roots are
---laid on the new skin, and what then lies in the new head is moved out.
---@param fields coif.Piece.carry.fields
---@return coif.Piece
function Piece:carry(fields) end

---How hair looks; made by `coif.material.hair`.
---@class coif.HairMaterial
local HairMaterial = {}

---A finished hairstyle.
---@class coif.Scene
local Scene = {}

---A running test: runs styles, and states what is expected. There is one only under `coif test`.
---@class coif.Test
local Test = {}

---Runs a style: `t:run "ponytail.lua" { length = 60 }`. Its path begins at the test's folder. A table of
---parameters gives them as `--set` does; `seed` in it is the run's seed.
---@param script string # The style's file.
---@param parameters? table<string, any> # Parameters by name.
---@return coif.TestScene
function Test:run(script, parameters) end

---A scene that the test itself made, with its parts by name.
---@param scene coif.Scene # What `coif.scene` gave.
---@param frame? number # Of a scene that moves, which frame, from 1; the one that its still pictures show when left out. [whole; 1 to 1000000000]
---@return coif.TestScene
function Test:scene(scene, frame) end

---Expects two values to be the same: numbers, texts, vectors, or tables of them, entry by entry.
---@param got? any # What there is.
---@param want? any # What there should be.
---@return boolean
function Test:equal(got, want) end

---Expects two numbers, or two vectors, to be no farther apart than the tolerance.
---@param got any # What there is.
---@param want any # What there should be.
---@param tolerance number # How far apart they may be. [0 or more]
---@return boolean
function Test:near(got, want, tolerance) end

---Expects a number to be less than another.
---@param got number # What there is.
---@param limit number # What it must stay below.
---@return boolean
function Test:less(got, limit) end

---Expects a number to be greater than another.
---@param got number # What there is.
---@param limit number # What it must exceed.
---@return boolean
function Test:greater(got, limit) end

---Expects a number to lie between two others, both allowed.
---@param got number # What there is.
---@param least number # The least allowed.
---@param most number # The greatest allowed.
---@return boolean
function Test:between(got, least, most) end

---Expects a value to be neither false nor nil.
---@param value? any # Anything.
---@param message? string # What it means when it does not hold.
---@return boolean
function Test:ok(value, message) end

---Stops the test, as failed, unless a value is neither false nor nil: `t:require(t:less(a, b))`.
---@param value? any # Anything.
---@param message? string # What it means when it does not hold.
---@return any
function Test:require(value, message) end

---Expects a function to raise an error.
---@param body fun(): any? # Called without arguments.
---@param text? string # What the error must say, as a part of its message.
---@return boolean
function Test:error(body, text) end

---How it is drawn and compared.
---@class (exact) coif.Test.preview.options
---@field views? ("front"|"back"|"left"|"right"|"top"|"three-quarter"|"back-three-quarter")[] # The views, side by side; the scene's first one when left out.
---@field size? number # Width of one view in pixels; its height is nine eighths of it. [whole; px; 16 to 1024; default 120]
---@field tolerance? number # How far a channel of a pixel may differ, out of 255. [whole; 0 to 255; default 1]
---@field background? "white"|"dark" # The colour behind everything, instead of the scene's own.
---@field frame? number # Of a scene that moves, which frame, from 1; the scene's own when left out. [whole; 1 to 1000000000]

---Expects the preview of a scene to be the golden picture `golden/NAME.png` beside the test.
---@param scene coif.TestScene|coif.Scene # What `t:run` gave, or a scene.
---@param name string # Name of the picture: letters, digits, `-` and `_`.
---@param options? coif.Test.preview.options # How it is drawn and compared.
---@return boolean
function Test:preview(scene, name, options) end

---A grid of control points; what is inside follows them, what is outside stays.
---@class coif.Lattice
---@field count number # How many control points.
local Lattice = {}

---What `Lattice:move` takes.
---@class (exact) coif.Lattice.move.fields
---@field i? number|number[]|nil # Along the first edge (to the head's left): one index, or { first, last }.
---@field j? number|number[]|nil # Along the second edge (up).
---@field k? number|number[]|nil # Along the third edge (to the front).
---@field group? string # A named group.
---@field by? coif.Point|fun(place: vector, i: number, j: number, k: number): vector # How far; or a function that is told where a point stands and its indices, and returns how far.
---@field scale? number|coif.Point|nil # Stretch along the axes of space: one number for all, or three.
---@field turn? number # Turn about `axis`. [degrees; -360 to 360; default 0]
---@field axis? coif.Direction # The axis of the turn. [default { 0, 1, 0 }]
---@field about? coif.Point # The place that scaling and turning leave where it is; the middle of the points when left out. [cm]

---Moves control points: scales and turns them about a place, then shifts them. Without `i`, `j`, `k` or `group`
---all of them; fixed ones stay.
---@param fields? coif.Lattice.move.fields
---@return coif.Lattice
function Lattice:move(fields) end

---What `Lattice:group` takes.
---@class (exact) coif.Lattice.group.fields
---@field name string # The name.
---@field i? number|number[]|nil # Along the first edge: one index, or { first, last }.
---@field j? number|number[]|nil # Along the second edge.
---@field k? number|number[]|nil # Along the third edge.

---Gives control points a name, to move them by it later.
---@param fields coif.Lattice.group.fields
---@return coif.Lattice
function Lattice:group(fields) end

---What `Lattice:mark` takes.
---@class (exact) coif.Lattice.mark.fields
---@field kind "overall"|"feature"|"fixed" # The kind.
---@field i? number|number[]|nil # Along the first edge: one index, or { first, last }.
---@field j? number|number[]|nil # Along the second edge.
---@field k? number|number[]|nil # Along the third edge.
---@field group? string # A named group.

---Says what control points are for: `overall`, `feature` or `fixed`. It may change between steps.
---@param fields coif.Lattice.mark.fields
---@return coif.Lattice
function Lattice:mark(fields) end

---What `Lattice:hold` takes.
---@class (exact) coif.Lattice.hold.fields
---@field [integer] coif.Point # The places. [cm]
---@field power? number # How sharply the hold falls off: the exponent of the affinity. [0.5 to 8; default 2]

---Holds places of the object itself: what is near them moves less, and they do not move at all.
---@param fields coif.Lattice.hold.fields
---@return coif.Lattice
function Lattice:hold(fields) end

---What `Lattice:follow` takes.
---@class (exact) coif.Lattice.follow.fields
---@field power? number # The exponent of the affinity. [0.5 to 8; default 2]

---Lets overall control points follow the feature points that were moved, held back by the fixed ones.
---@param fields? coif.Lattice.follow.fields
---@return coif.Lattice
function Lattice:follow(fields) end

---Where a control point stands.
---@param i number # Index along the first edge, from 0. [whole]
---@param j number # Index along the second edge, from 0. [whole]
---@param k number # Index along the third edge, from 0. [whole]
---@return vector
function Lattice:place(i, j, k) end

---Fixed points and operated points in space.
---@class coif.Pins
local Pins = {}

---The next step: every point stands where this step leaves it, and none has a target yet.
---@return coif.Pins
function Pins:settled() end

---What `Pins:mark` takes.
---@class (exact) coif.Pins.mark.fields
---@field name string # The name of the point.
---@field kind "overall"|"feature"|"fixed" # Its kind from now on.
---@field to? coif.Point # Where it goes now. [cm]

---The next step: gives a named point another kind, and perhaps a target.
---@param fields coif.Pins.mark.fields
---@return coif.Pins
function Pins:mark(fields) end

---A closed surface of scattered control points; what is inside follows them, what is outside stays.
---@class coif.Cage
---@field count number # How many control points.
local Cage = {}

---What `Cage:move` takes.
---@class (exact) coif.Cage.move.fields
---@field points? string|number|(string|number)[]|nil # Which, by name or by number from 1: one, or a list.
---@field near? coif.Point # Those near this place; without `within` the nearest one alone. [cm]
---@field within? number # How near. [cm; 0 to 1000]
---@field where? fun(place: vector, number: number): boolean # Those for which a function returns true: it is told where a point stands, and its number.
---@field by? coif.Point|fun(place: vector, number: number): vector # How far; or a function that is told where a point stands and its number, and returns how far.
---@field scale? number|coif.Point|nil # Stretch along the axes of space: one number for all, or three.
---@field turn? number # Turn about `axis`. [degrees; -360 to 360; default 0]
---@field axis? coif.Direction # The axis of the turn. [default { 0, 1, 0 }]
---@field about? coif.Point # The place that scaling and turning leave where it is; the middle of the points when left out. [cm]

---Moves control points: scales and turns them about a place, then shifts them. Without `points`, `near` or `where`
---all of them; fixed ones stay.
---@param fields? coif.Cage.move.fields
---@return coif.Cage
function Cage:move(fields) end

---What `Cage:mark` takes.
---@class (exact) coif.Cage.mark.fields
---@field kind "overall"|"feature"|"fixed" # The kind.
---@field points? string|number|(string|number)[]|nil # Which, by name or by number from 1: one, or a list.
---@field near? coif.Point # Those near this place; without `within` the nearest one alone. [cm]
---@field within? number # How near. [cm; 0 to 1000]
---@field where? fun(place: vector, number: number): boolean # Those for which a function returns true: it is told where a point stands, and its number.

---Says what control points are for: `overall`, `feature` or `fixed`. It may change between steps.
---@param fields coif.Cage.mark.fields
---@return coif.Cage
function Cage:mark(fields) end

---What `Cage:hold` takes.
---@class (exact) coif.Cage.hold.fields
---@field [integer] coif.Point # The places. [cm]
---@field power? number # How sharply the hold falls off: the exponent of the affinity. [0.5 to 8; default 2]

---Holds places of the object itself: what is near them moves less, and they do not move at all.
---@param fields coif.Cage.hold.fields
---@return coif.Cage
function Cage:hold(fields) end

---What `Cage:follow` takes.
---@class (exact) coif.Cage.follow.fields
---@field power? number # The exponent of the affinity. [0.5 to 8; default 2]

---Lets overall control points follow the feature points that were moved, held back by the fixed ones.
---@param fields? coif.Cage.follow.fields
---@return coif.Cage
function Cage:follow(fields) end

---Where a control point stands.
---@param point string|number # Its name, or its number from 1.
---@return vector
function Cage:place(point) end

---A smooth motion of all space through scattered points.
---@class coif.Warp
local Warp = {}

---A garment: a surface in named parts, with tapes around it.
---@class coif.Garment
---@field kind string # `skirt`, `dress`, `shirt`, `trousers`, `form`, or the name of its file.
local Garment = {}

---What `Garment:girth` takes.
---@class (exact) coif.Garment.girth.fields
---@field tape? string # The name of a tape.
---@field height? number # Or any height. [cm]
---@field side? "middle"|"left"|"right" # Which of several outlines: the largest, or the largest on one side.
---@field parts? string[] # Only these parts.
---@field measure? "tape"|"perimeter" # As a tape measure reads it, or along the cloth into every fold. [default "tape"]

---What a tape reads.
---@param fields? coif.Garment.girth.fields
---@return number
function Garment:girth(fields) end

---What `Garment:tape` takes.
---@class (exact) coif.Garment.tape.fields
---@field name string # Its name.
---@field height number # Its height. [cm]
---@field side? "middle"|"left"|"right" # Which of several outlines. [default "middle"]
---@field parts? string[] # Only around these parts.

---Puts a tape around it: a name for a height.
---@param fields coif.Garment.tape.fields
---@return coif.Garment
function Garment:tape(fields) end

---What `Garment:fit` takes.
---@class (exact) coif.Garment.fit.fields
---@field measure? "tape"|"perimeter" # How girths are measured. [default "tape"]
---@field hold? "back"|"front"|"left"|"right"|coif.Point[]|nil # Places of the cloth that stay: "back", "front", "left", "right", or a list of points.
---@field power? number # How sharply the hold falls off: the exponent of the affinity. [0.5 to 8; default 2]
---@field reach? number # How far above and below a tape the cloth may move, at most. [cm; 1 to 100; default 18]
---@field soft? number # How far sewn-on parts follow. [cm; 0.1 to 50; default 8]
---@field [string] number|string|coif.Point[] # What the tape of that name shall read, cm. [cm]

---Finds the motion of control points that makes tapes read what is wanted, each to a tenth of a millimetre:
---`garment:fit { waist = 67 }`. The rest is held: nothing moves beyond the tapes above and below.
---@param fields? coif.Garment.fit.fields
---@return coif.Garment
function Garment:fit(fields) end

---What `Garment:split` takes.
---@class (exact) coif.Garment.split.fields
---@field [string] number[] # From which height to which, cm. [cm]

---Names parts by bands of heights: `garment:split { bust = { -48, -30 }, waist = { -67, -48 } }`.
---@param fields? coif.Garment.split.fields
---@return coif.Garment
function Garment:split(fields) end

---What `Garment:clear` takes.
---@class (exact) coif.Garment.clear.fields
---@field body coif.Garment|coif.Head # The body: a dress form, any garment that encloses something, or a head.
---@field margin? number # How far from the body it shall lie. [cm; 0 to 10; default 0.3]

---Pushes the cloth out of a body where it dips in, smoothly.
---@param fields coif.Garment.clear.fields
---@return coif.Garment
function Garment:clear(fields) end

---What `Garment:deform` takes.
---@class (exact) coif.Garment.deform.fields
---@field [integer] coif.Lattice|coif.Cage|coif.Pins|coif.Warp # Lattices, cages, pins and warps, in the order they act.

---Moves it by lattices, cages, pins and warps, one after the other.
---@param fields coif.Garment.deform.fields
---@return coif.Garment
function Garment:deform(fields) end

---What `Garment:bend` takes.
---@class (exact) coif.Garment.bend.fields
---@field angle number # By how much at the far end. [degrees; -180 to 180]
---@field towards? coif.Direction # Which way the far end goes. [default { 0, 0, 1 }]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]

---Bends it, as a whole: what lies at the far end turns by the angle, in between by a part of it.
---@param fields coif.Garment.bend.fields
---@return coif.Garment
function Garment:bend(fields) end

---What `Garment:taper` takes.
---@class (exact) coif.Garment.taper.fields
---@field width number # Width at the far end as a multiple of what it was: below 1 narrows, above 1 flares. [0.01 to 10]
---@field along? coif.Direction # From the near end to the far end. [default { 0, -1, 0 }]
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]
---@field about? coif.Point # The axis that it narrows towards goes through this place; the middle when left out. [cm]

---Makes it narrower, or wider (flared), towards the far end.
---@param fields coif.Garment.taper.fields
---@return coif.Garment
function Garment:taper(fields) end

---What `Garment:lift` takes.
---@class (exact) coif.Garment.lift.fields
---@field by number # How far at the far end. [cm; -100 to 100]
---@field towards? coif.Direction # Which way. [default { 0, 1, 0 }]
---@field along? coif.Direction # From the near end to the far end; as `towards` when left out.
---@field from? number # Where it begins, as a part of the way from the near end. [0 to 0.95; default 0]

---Lifts it: what lies at the far end is moved by the whole distance, what lies at the near end stays.
---@param fields coif.Garment.lift.fields
---@return coif.Garment
function Garment:lift(fields) end

---The same garment somewhere else.
---@param by coif.Point # How far. [cm]
---@return coif.Garment
function Garment:shifted(by) end

---What `Garment:ribbon` takes.
---@class (exact) coif.Garment.ribbon.fields
---@field tape string # The name of a tape.
---@field width? number # Its width. [cm; 0.2 to 20; default 1.6]
---@field colour? coif.Colour # Its colour. [default "#f2c12e"]
---@field label? boolean # Whether pictures say beside it what it reads. [default true]

---A measuring tape laid around it, as a thing to be seen.
---@param fields coif.Garment.ribbon.fields
---@return coif.Garment
function Garment:ribbon(fields) end

---What `Garment:material` takes.
---@class (exact) coif.Garment.material.fields
---@field colour? coif.Colour # Its colour. [default "#6f83a8"]
---@field roughness? number # 0 mirror to 1 chalk. [0 to 1; default 0.85]

---The same garment with another look.
---@param fields? coif.Garment.material.fields
---@return coif.Garment
function Garment:material(fields) end

---The names of its parts.
---@return string[]
function Garment:parts() end

---The names of its tapes.
---@return string[]
function Garment:tapes() end

---Figures: `vertices`, `triangles`, `parts`, `min` and `max` (corners of the bounding box), and the girth of every
---tape by its name.
---@return table<string, any>
function Garment:stats() end

---The scene of a style, in a test; its parts are reached by name: `scene.hair`, `scene.head`. The style is run
---when its scene is first asked for.
---@class coif.TestScene
---@field [string] coif.TestPart
---@overload fun(parameters: table<string, any>): coif.TestScene
local TestScene = {}

---The same style with these parameters; `scene { length = 60 }` is short for it.
---@param parameters table<string, any> # Parameters by name.
---@return coif.TestScene
function TestScene:with(parameters) end

---A scene that moves as it is at a frame; its figures are then those of that frame. Without it they are those of
---the frame that still pictures show.
---@param frame number # Which frame, from 1; past the end a loop begins anew, anything else stands still. [whole; 1 to 1000000000]
---@return coif.TestScene
function TestScene:at(frame) end

---The figures of all parts together; see `TestPart:stats`.
---@return table<string, any>
function TestScene:stats() end

---A part of a tested scene: hair, or a head.
---@class coif.TestPart
local TestPart = {}

---Figures. Of hair: `strands`, `points`, `guides`, `mean_length`, `longest`, `shortest` (cm), `inside` (strands
---with a node or a segment inside the head, and tufts that lie too deep in it beyond their buried bases, `bury`
---left out), `coverage` (the fraction of the scalp within 1 cm of a strand or of a surface of stylised hair),
---`symmetry` (mean distance in cm from the hair's mirror image to the hair; where there are strands and locks, of
---those that have the greater). Of a surface: `points`, `triangles`, `tufts`. Of all: `min` and `max`, the corners
---of the bounding box.
---@return table<string, any>
function TestPart:stats() end

---The fraction of the scalp that has hair within some distance: a strand, or a surface of stylised hair.
---@param reach? number # How near hair must come. [cm; 0.01 to 100; default 1]
---@return number
function TestPart:coverage(reach) end
