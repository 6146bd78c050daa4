local function broken(
return 1
