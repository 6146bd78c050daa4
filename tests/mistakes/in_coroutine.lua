local step = coroutine.wrap(function()
  local t = nil
  return t.x
end)
step()
