//! Laws of growing, deforming and filling.
