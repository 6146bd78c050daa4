local head = coif.head()
return coif.scene { head, motion = head:motion { { time = 0 }, { time = 1, yaw = 60 }, { time = 0.5 } } }
