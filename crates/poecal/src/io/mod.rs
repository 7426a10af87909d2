//! Files: robot models, measurements, results. The only module that opens them; it computes nothing beyond units.

pub mod measurements;
