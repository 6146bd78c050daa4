//! todo
pub mod mannequin;
