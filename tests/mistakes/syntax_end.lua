local function side(sign)
  if sign > 0 then
    return 1
end
return side(1)
