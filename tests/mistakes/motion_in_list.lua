local head = coif.head()
return coif.scene { head, head:motion { { time = 0 }, { time = 1, yaw = 60 } } }
