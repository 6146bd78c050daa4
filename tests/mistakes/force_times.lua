return coif.force.wind { direction = { 1, 0, 0 }, over_time = { { 0, 1 }, { 2, 0 }, { 1, 1 } } }
