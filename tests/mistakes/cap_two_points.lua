local head = coif.head()
return coif.scene { head, coif.cap { border = { head:at("left_ear"), head:at("right_ear") } } }
