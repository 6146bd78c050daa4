//! The cartoon mannequin.
use super::Form;
/// The form of the cartoon.
pub fn form() -> Form {
    super::adult::form()
}
