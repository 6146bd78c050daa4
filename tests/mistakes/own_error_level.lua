local function check(length)
  error("the strand is too long", 2)
end
check(12)
