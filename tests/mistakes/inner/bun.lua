local bun = {}

function bun.make(head)
  return head.at("occiput")
end

return bun
