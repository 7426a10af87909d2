//! Frames of stations that were not fitted.

use std::borrow::Cow;

use poecal_fit::start::{Registration, register};
use poecal_fit::state::{Estimate, Session};
use poecal_model::measurement::{Dataset, Noise};

/// Stations that only rows outside the fit name.
pub(crate) fn stations_to_locate(data: &Dataset, fitted: &[u32]) -> Vec<usize> {
    if data.station_count() == 1 {
        return Vec::new();
    }
    let mut is_fitted = vec![false; data.station_count()];
    fitted.iter().for_each(|&row| is_fitted[data.observations[row as usize].station] = true);
    let mut has_rows = vec![false; data.station_count()];
    data.observations.iter().for_each(|row| has_rows[row.station] = true);
    (0..data.station_count()).filter(|&station| has_rows[station] && !is_fitted[station]).collect()
}

/// Held-out rows of fitted stations: bounds do not apply to frames that are determined from the judging rows themselves.
pub(crate) fn rows_of_fitted_stations(data: &Dataset, fitted: &[u32], held_out: &[u32]) -> Vec<u32> {
    let others = stations_to_locate(data, fitted);
    let is_promised = |row: &u32| !others.contains(&data.observations[*row as usize].station);
    held_out.iter().copied().filter(is_promised).collect()
}

/// The estimate with the frames of stations that no fitted row sees, determined from their own rows with all else held (theory.md §9, *Places that
/// are held out*).
pub(crate) fn locate_stations<'e>(
    session: &Session<'_>,
    fitted: &[u32],
    estimate: &'e Estimate,
    noise: Noise,
) -> Cow<'e, Estimate> {
    let mut stations = stations_to_locate(session.data, fitted);
    stations.retain(|&station| session.unknowns.moves_frame(station) && estimate.tree.shared_target(station).is_none());
    if stations.is_empty() || !session.device_free {
        return Cow::Borrowed(estimate);
    }
    let of_them = |row: &u32| stations.contains(&session.observation(*row).station);
    let rows: Vec<u32> = session.data.all_rows().into_iter().filter(of_them).collect();
    // A known length between them is judged too.
    let mut data = session.data.clone();
    data.lengths.clear();
    let session = Session { data: &data, ..*session };
    let registration = Registration { session, rows: &rows, noise, targets_free: false, prior: None };
    Cow::Owned(register(&registration, estimate).0)
}
