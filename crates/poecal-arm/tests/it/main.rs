//! Arms beside the screws' own exponentials, and all branches beside a search.

#![allow(clippy::unwrap_used)]

mod branches;
mod calibrated;
mod held;
mod kinematics;
mod nearest;
mod numbers;
#[path = "../../../poecal/tests/trials/mod.rs"]
#[allow(dead_code)]
mod trials;
