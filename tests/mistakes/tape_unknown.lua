local skirt = coif.garment.skirt {}
return coif.scene { skirt:fit { wais = 60 } }
