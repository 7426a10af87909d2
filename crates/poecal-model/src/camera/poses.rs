//! All possible poses of a board in a picture.

use super::pnp::poses_of_rays;
use super::sighting::SightingInput;
use super::{middle, normal};
use nalgebra::Vector3;
use poecal_arm::lie::{Pose, rotation};

/// Fewest corners from which a pose is computed: of three points there are up to four.
const FEWEST: usize = 4;
/// Factor of the first pose's error beyond which a second pose of a picture does not count.
const WORSE: f64 = 20.0;
/// Two poses that differ by less are one, m and rad.
const SAME: f64 = 1e-4;

impl SightingInput<'_> {
    /// Poses that fit the corners, the best first; a flat board that is far away or small has two.
    ///
    /// # Errors
    /// A message with the reason why there is none.
    pub fn poses(&self) -> Result<Vec<Pose>, String> {
        let count = self.corners.len();
        if count < FEWEST {
            return Err(format!("{count} corner{}", if count == 1 { "" } else { "s" }));
        }
        if self.dimensions() < 2 {
            return Err("its corners are on a line".to_owned());
        }
        let mut found: Vec<(f64, Pose)> = Vec::new();
        let by_rays = poses_of_rays(&self.rays());
        let mirrored: Vec<Pose> = if self.dimensions() == 2 {
            by_rays.iter().map(|pose| self.tilted_back(pose)).collect()
        } else {
            Vec::new()
        };
        for start in by_rays.into_iter().chain(mirrored) {
            let Some(sighting) = self.sighting(&start, true) else { continue };
            let pose = sighting.camera_from_board;
            let cost = sighting.cost / sighting.freedom.max(1.0) + lost_weight_cost(&sighting.weights);
            let is_known = |(_, known): &(f64, Pose)| {
                let (shift, turn) = known.distance_and_angle(&pose);
                shift < SAME && turn < SAME
            };
            if cost.is_finite() && !found.iter().any(is_known) {
                found.push((cost, pose));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = found.first().map_or(f64::INFINITY, |(cost, _)| *cost);
        let poses: Vec<Pose> = found
            .into_iter()
            .filter(|(cost, _)| *cost <= WORSE * WORSE * best.max(1.0))
            .map(|(_, pose)| pose)
            .collect();
        if poses.is_empty() { Err("no pose in front of the camera fits its corners".to_owned()) } else { Ok(poses) }
    }

    /// A flat board tilted by as much in the opposite direction: its normal is mirrored at the line of sight, its middle stays.
    fn tilted_back(&self, pose: &Pose) -> Pose {
        let points: Vec<Vector3<f64>> = self.rays().iter().map(|(point, _)| *point).collect();
        let (middle, normal) = (middle(&points), pose.rotation * normal(&points));
        let place = pose.act(&middle);
        let sight = place.normalize();
        let other = sight * (2.0 * normal.dot(&sight)) - normal;
        let turned = rotation::shortest_arc(&normal, &other) * pose.rotation;
        Pose::new(turned, place - turned * middle)
    }
}

/// Cost of the corners without weight for a pose that others fit: as if each were at the bound.
fn lost_weight_cost(weights: &[f64]) -> f64 {
    weights.iter().map(|weight| 36.0 * (1.0 - weight)).sum::<f64>() / weights.len().max(1) as f64
}
