//! Arms compared with the screws' own exponentials, and all branches compared with a search.

#![allow(clippy::unwrap_used, clippy::panic)]

mod branches;
mod calibrated;
mod held;
mod kinematics;
mod nearest;
mod numbers;
