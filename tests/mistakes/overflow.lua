local function strand(n)
  return 1 + strand(n + 1)
end
return strand(0)
