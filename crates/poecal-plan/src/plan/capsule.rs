//! Capsules around the shapes of links: all points within a distance of a segment.

use nalgebra::Vector3;

use poecal_arm::lie::Pose;
use poecal_model::robot::Body;
use poecal_numerics::linalg;

/// All points within a distance of a segment, on a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Capsule {
    /// The link, for messages.
    pub link: String,
    /// The body that carries it.
    pub body: Body,
    /// Ends of the segment in the frame of the joint that moves the body, or in the base, metres.
    pub ends: [Vector3<f64>; 2],
    /// Radius, metres.
    pub radius_m: f64,
}

impl Capsule {
    /// A capsule that contains balls of a radius about all of some points: along the direction of their greatest spread. `None` without points.
    #[must_use]
    pub fn enclosing(link: &str, body: Body, points: &[Vector3<f64>], grown_m: f64) -> Option<Capsule> {
        let count = points.len();
        if count == 0 || !points.iter().all(|point| point.iter().all(|it| it.is_finite())) {
            return None;
        }
        // The middle of the box about the points is used, not their mean: meshes have more vertices where they are finer.
        let bound = |pick: fn(f64, f64) -> f64, k: usize| points.iter().map(|it| it[k]).reduce(pick).unwrap_or(0.0);
        let middle = Vector3::from_fn(|k, _| 0.5 * (bound(f64::min, k) + bound(f64::max, k)));
        let mut upper = [0.0; 9];
        for point in points {
            let from = point - middle;
            (0..9).for_each(|at| upper[at] += from[at / 3] * from[at % 3]);
        }
        let (_, vectors) = linalg::symmetric_eigen(&upper, 3);
        let mut best: Option<(f64, Capsule)> = None;
        for at in 0..3 {
            let axis = Vector3::new(vectors[(0, at)], vectors[(1, at)], vectors[(2, at)]);
            let parts = || {
                points.iter().map(|point| {
                    let from = point - middle;
                    let along = axis.dot(&from);
                    (along, (from - axis * along).norm())
                })
            };
            let radius = parts().map(|it| it.1).fold(0.0, f64::max);
            // The caps contain points nearer to the axis than the radius.
            let cap = |off: f64| (radius * radius - off * off).max(0.0).sqrt();
            let last = parts().map(|(along, off)| along - cap(off)).fold(f64::NEG_INFINITY, f64::max);
            let first = parts().map(|(along, off)| along + cap(off)).fold(f64::INFINITY, f64::min);
            let (first, last) = if first <= last {
                (first, last)
            } else {
                let mid = 0.5 * (first + last);
                (mid, mid)
            };
            let volume = radius * radius * (last - first + 4.0 / 3.0 * radius);
            if best.as_ref().is_none_or(|(least, _)| volume < *least) {
                let ends = [middle + axis * first, middle + axis * last];
                // Rounding leaves no point outside.
                let radius_m = (radius + grown_m) * (1.0 + 1e-12) + 1e-9;
                best = Some((volume, Capsule { link: link.to_owned(), body, ends, radius_m }));
            }
        }
        best.map(|it| it.1)
    }

    /// Its segment in the base, with the frames of the joints.
    pub(crate) fn segment(&self, frames: &[Pose]) -> [Vector3<f64>; 2] {
        let frame = self.body.joint().and_then(|joint| frames.get(joint));
        self.ends.map(|end| frame.map_or(end, |frame| frame.rotation * end + frame.translation))
    }
}

/// Distance between two segments.
pub(crate) fn segment_distance([a, b]: &[Vector3<f64>; 2], [c, d]: &[Vector3<f64>; 2]) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, uv, vv, uw, vw) = (u.dot(&u), u.dot(&v), v.dot(&v), u.dot(&w), v.dot(&w));
    let determinant = uu * vv - uv * uv;
    let ratio = |numerator: f64, denominator: f64| {
        if denominator > 1e-18 { (numerator / denominator).clamp(0.0, 1.0) } else { 0.0 }
    };
    let mut s = if determinant > 1e-12 * uu * vv { ratio(uv * vw - vv * uw, determinant) } else { 0.0 };
    let t = ratio(uv * s + vw, vv);
    s = ratio(uv * t - uw, uu);
    (w + u * s - v * t).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_model::simulate::random;
    use rand_chacha::ChaCha8Rng;
    use rand_core::SeedableRng;

    #[test]
    fn capsules_contain_their_points_and_distances_are_those_of_samples() {
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let mut worst: f64 = 0.0;
        for _ in 0..200 {
            let stretch = random::normal_vector(&mut generator);
            let points: Vec<Vector3<f64>> =
                (0..40).map(|_| random::normal_vector(&mut generator).component_mul(&stretch)).collect();
            let capsule = Capsule::enclosing("link", Body::Base, &points, 0.0).unwrap();
            for point in &points {
                let off = segment_distance(&capsule.ends, &[*point, *point]);
                assert!(off <= capsule.radius_m, "{off} {}", capsule.radius_m);
            }
            let mut end = || random::normal_vector(&mut generator);
            let (first, second) = ([end(), end()], [end(), end()]);
            let at = |[a, b]: &[Vector3<f64>; 2], k: usize| a + (b - a) * (k as f64 / 200.0);
            let sampled = (0..=200)
                .flat_map(|i| (0..=200).map(move |j| (i, j)))
                .map(|(i, j)| (at(&first, i) - at(&second, j)).norm())
                .fold(f64::INFINITY, f64::min);
            let found = segment_distance(&first, &second);
            assert!(found <= sampled + 1e-12);
            worst = worst.max(sampled - found);
        }
        println!("sampled distances of segments are at most {worst:.1e} longer");
        // Half a step of each segment, to second order where they cross.
        assert!(worst < 0.03);
    }
}
