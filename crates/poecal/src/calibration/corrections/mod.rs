//! What joints really do beyond geometry: terms of their values and of their bearings, fitted beside the screws with priors (theory.md §6).

mod choice;
mod fit;
mod model;
mod sizes;

pub use choice::TriedSizes;
pub use fit::{Correction, correct};
pub use model::CorrectionModel;
pub use sizes::{Sizes, TermGroup};
