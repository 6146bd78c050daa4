local p = coif.params { length = 45 }
print(p.lenght)
