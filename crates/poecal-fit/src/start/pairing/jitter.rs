//! Errors of single time stamps of a recording in motion.

use nalgebra::Vector3;

use crate::parameters::{ClockUnknown, ParameterColumns as _};
use crate::state::{ClockTerm, Estimate, Linkage, RowChain, Session};
use poecal_model::measurement::Quantity;

/// Fewest rows for an estimate.
const FEWEST: usize = 30;

/// Standard deviation of single stamps, seconds, by the excess of errors along the motion over those across it; 0 without an excess.
pub(crate) fn jitter(session: &Session<'_>, rows: &[u32], estimate: &Estimate) -> f64 {
    let (linkage, mut chain) = (Linkage::new(estimate), RowChain::default());
    let (mut along, mut across, mut squares, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (error, &row) in session.errors(rows, estimate).iter().zip(rows) {
        let seen = session.observation(row);
        chain.evaluate(&linkage, session.packed, row as usize, seen);
        let mut twist = [(Vector3::zeros(), Vector3::zeros())];
        let lag = ClockUnknown { station: seen.station, term: ClockTerm::Lag };
        lag.target_twists(&chain, seen.target, &mut twist);
        let [(speed, _)] = twist;
        let length = speed.norm();
        if length < SLOW_M_PER_S {
            continue;
        }
        let vector = error.vector(Quantity::Position);
        let part = vector.dot(&speed) / length;
        along += part * part;
        across += 0.5 * (vector.norm_squared() - part * part);
        (squares, count) = (squares + length * length, count + 1.0);
    }
    if count < FEWEST as f64 || squares <= 0.0 { 0.0 } else { f64::sqrt(f64::max(along - across, 0.0) / squares) }
}

/// Speed below which a row has no information on its stamp, m/s.
const SLOW_M_PER_S: f64 = 0.05;
