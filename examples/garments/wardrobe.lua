-- wardrobe.lua: the library of classed pieces on their form: skirt, shirt, dress, trousers. All are made from measures.
local p = coif.params {
  bust  = { 84, min = 70, max = 120, unit = "cm", doc = "girth of the bust" },
  waist = { 62, min = 50, max = 110, unit = "cm", doc = "girth of the waist" },
  hip   = { 90, min = 70, max = 130, unit = "cm", doc = "girth of the hip" },
}

local form = coif.garment.form {
  bust = p.bust, waist = p.waist, hip = p.hip, colour = "#d9cbb2", roughness = 0.9,
}
local size = { bust = p.bust + 3, waist = p.waist + 3, hip = p.hip + 4 }

local shirt = coif.garment.shirt {
  bust = size.bust, waist = size.waist + 2, hip = size.hip, length = 41, colour = "#e8e4da",
}
local skirt    = coif.garment.skirt { waist = size.waist, hip = size.hip, hem = 165, colour = "#39466b" }
local dress    = coif.garment.dress { bust = size.bust, waist = size.waist, hip = size.hip, colour = "#8c2f39" }
local trousers = coif.garment.trousers { waist = size.waist, hip = size.hip, colour = "#4a4f45" }
local tee      = coif.garment.shirt { bust = size.bust, waist = size.waist + 4, hip = size.hip + 8, length = 56, sleeves = 14, neckline = 7, colour = "#c9a23f" }

-- each over a form of its own, pushed out where it would dip in
local scene = {}
local function stand(x, ...)
  table.insert(scene, form:shifted { x, 0, 0 })
  for _, piece in { ... } do
    table.insert(scene, piece:clear { body = form, margin = 0.4 }:shifted { x, 0, 0 })
  end
end
stand(-75, shirt, skirt)
stand(0, dress)
stand(75, tee, trousers)

return coif.scene { scene, views = { "front", "three-quarter" } }
