//! Locks that move: MeshIK over posed examples (Sumner, Zwicker, Gotsman, Popovic 2005), handles and their paths (Ren, Zhao,
//! Geng 2010).
