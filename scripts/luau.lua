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
