//! todo
pub mod load;
