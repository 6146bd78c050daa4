local dress = coif.garment.dress { waist = 57 }
return coif.scene { dress:fit { waist = 670 } }
