//! Barycentres in the base frame: by a stated device frame, or by one that is fitted to them.

use nalgebra::{Matrix3, Matrix3x6, Matrix6, Vector3};

use super::intervals::VariancePart;
use super::rows::PoseCell;
use poecal_arm::lie::{Pose, hat};
use poecal_fit::start::rigid_motion;
use poecal_numerics::error::{ErrorKind, Result};
use poecal_numerics::linalg;

/// Least standard deviation (metres) of the barycentres across the line that fits them best, for a frame to be fitted.
const FLAT_M: f64 = 1e-3;

/// Barycentres beside commanded positions, in the base frame.
pub(super) struct RegisteredBarycentres {
    pub(super) base_from_device: Pose,
    /// Barycentre less command of each pose, metres.
    pub(super) errors: Vec<Vector3<f64>>,
    /// Covariance of each barycentre, with its degrees of freedom.
    pub(super) own: Vec<VariancePart>,
    /// Effect of each barycentre on the fitted frame at each pose; none of a stated frame.
    pub(super) by_frame: Option<Vec<Vec<Matrix3<f64>>>>,
    /// Part of each cell's scatter in the covariance of each error.
    pub(super) parts: Vec<Vec<VariancePart>>,
}

/// Barycentres of cells in the base frame, beside where they should be; the frame is fitted to them (least squares) unless it is stated.
///
/// # Errors
/// [`ErrorKind::Measurement`] if the poses do not determine a frame.
pub(super) fn register(
    cells: &[PoseCell<'_>],
    wanted: &[Vector3<f64>],
    stated: Option<Pose>,
) -> Result<RegisteredBarycentres> {
    let (means, spreads): (Vec<_>, Vec<_>) = cells.iter().map(PoseCell::barycentre).unzip();
    if stated.is_none() {
        refuse_undetermined(&means)?;
    }
    let base_from_device = stated.unwrap_or_else(|| rigid_motion(&means, wanted));
    let places: Vec<Vector3<f64>> = means.iter().map(|it| base_from_device.act(it)).collect();
    let turn = base_from_device.rotation;
    let own: Vec<VariancePart> = spreads
        .iter()
        .zip(cells)
        .map(|(spread, cell)| {
            let count = cell.count() as f64;
            VariancePart { covariance: turn * spread * turn.transpose() / count, freedom: count - 1.0 }
        })
        .collect();
    let all = || 0..cells.len();
    let by_frame = match stated {
        Some(_) => None,
        None => {
            let frame = FrameFit::new(&places)?;
            Some(all().map(|i| all().map(|k| frame.effect(i, k)).collect()).collect::<Vec<Vec<_>>>())
        }
    };
    let part = |i: usize, k: usize, by: &Matrix3<f64>| {
        let left = if i == k { Matrix3::identity() + by } else { *by };
        VariancePart { covariance: left * own[k].covariance * left.transpose(), freedom: own[k].freedom }
    };
    let parts = all().map(|i| match &by_frame {
        None => vec![own[i]],
        Some(by) => by[i].iter().enumerate().map(|(k, by)| part(i, k, by)).collect(),
    });
    let parts = parts.collect();
    let errors = places.iter().zip(wanted).map(|(place, wanted)| place - wanted).collect();
    Ok(RegisteredBarycentres { base_from_device, errors, own, by_frame, parts })
}

fn refuse_undetermined(means: &[Vector3<f64>]) -> Result<()> {
    if means.len() >= 3 && linalg::principal_spread(means)[1] > FLAT_M {
        return Ok(());
    }
    ErrorKind::Measurement.refuse(format!(
        "found {} poses from which no frame of the device can be fitted, expected three or more that are not on a line (the standard has five): measure \
         these, or state the frame with --device-frame base",
        means.len()
    ))
}

/// The fit of a frame to points, linearised.
struct FrameFit {
    rows: Vec<Matrix3x6<f64>>,
    inverse: Matrix6<f64>,
}

impl FrameFit {
    fn new(places: &[Vector3<f64>]) -> Result<Self> {
        let middle = places.iter().sum::<Vector3<f64>>() / places.len().max(1) as f64;
        let row = |place: &Vector3<f64>| {
            let mut row = Matrix3x6::zeros();
            row.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
            row.fixed_view_mut::<3, 3>(0, 3).copy_from(&-hat(&(place - middle)));
            row
        };
        let rows: Vec<Matrix3x6<f64>> = places.iter().map(row).collect();
        let normal: Matrix6<f64> = rows.iter().map(|row| row.transpose() * row).sum();
        let Some(inverse) = linalg::inverse_6(normal) else {
            return ErrorKind::Measurement
                .refuse("found poses on a line, expected others beside it: they do not determine the device frame");
        };
        Ok(FrameFit { rows, inverse })
    }

    /// Effect of point `k` on the frame at point `i`.
    fn effect(&self, i: usize, k: usize) -> Matrix3<f64> {
        -self.rows[i] * self.inverse * self.rows[k].transpose()
    }
}
