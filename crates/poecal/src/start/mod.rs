//! Where the device stands and where the targets sit, found without an initial guess and with nominal screws (docs/theory.md §6).

mod averaging;
mod hand_eye;
mod registration;
mod robust;
mod stations;

pub(crate) use averaging::mean_rotation;
pub use registration::{Registration, register_again};
pub(crate) use registration::{free_parameters, register_roughly, target_parameters};
pub use robust::register_robustly;
pub use stations::register;
