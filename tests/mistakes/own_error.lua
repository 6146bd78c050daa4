local function check(length)
  if length > 10 then
    error("the strand is too long: " .. length)
  end
end
check(12)
