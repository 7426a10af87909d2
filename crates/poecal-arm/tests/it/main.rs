//! Arms beside the screws' own exponentials, and all branches beside a search.

#![allow(clippy::unwrap_used, clippy::panic)]

mod branches;
mod calibrated;
mod held;
mod kinematics;
mod nearest;
mod numbers;
