local m = coif.material.hair { shine = 1 }
m.shine = 0.5
