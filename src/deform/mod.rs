//! Free-form deformation with fixed points (Liu, Liu 2011): lattices, pins, girths; for any points whatever.
