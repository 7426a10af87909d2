//! Frames and vectors of several configurations. Every loop is over configurations and without branches, so that it compiles to
//! vector instructions. No product is fused with a sum, so that all instructions produce the bits of one configuration alone.

use crate::lie::Pose;
use crate::trig::cosine_and_sine;

/// A number for each of several configurations.
pub(crate) type NumberBatch<const N: usize> = [f64; N];
/// A vector for each of several configurations.
pub(crate) type VectorBatch<const N: usize> = [NumberBatch<N>; 3];

/// Adds other vectors times a number of each.
#[inline(always)]
pub(crate) fn add_times<const N: usize>(to: &mut VectorBatch<N>, of: &VectorBatch<N>, times: &NumberBatch<N>) {
    for l in 0..N {
        for k in 0..3 {
            to[k][l] += of[k][l] * times[l];
        }
    }
}

#[inline(always)]
pub(crate) fn cross<const N: usize>(a: &VectorBatch<N>, b: &VectorBatch<N>) -> VectorBatch<N> {
    let mut out = [[0.0; N]; 3];
    for l in 0..N {
        out[0][l] = a[1][l] * b[2][l] - a[2][l] * b[1][l];
        out[1][l] = a[2][l] * b[0][l] - a[0][l] * b[2][l];
        out[2][l] = a[0][l] * b[1][l] - a[1][l] * b[0][l];
    }
    out
}

#[inline(always)]
pub(crate) fn dot<const N: usize>(a: &VectorBatch<N>, b: &VectorBatch<N>) -> NumberBatch<N> {
    let mut out = [0.0; N];
    for l in 0..N {
        out[l] = a[0][l] * b[0][l] + a[1][l] * b[1][l] + a[2][l] * b[2][l];
    }
    out
}

/// `(cos, sin)` of angles.
#[inline(always)]
pub(crate) fn cosines_and_sines<const N: usize>(angles: &NumberBatch<N>) -> [NumberBatch<N>; 2] {
    let (mut c, mut s) = ([0.0; N], [0.0; N]);
    for l in 0..N {
        (c[l], s[l]) = cosine_and_sine(angles[l]);
    }
    [c, s]
}

/// A frame in several configurations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameBatch<const N: usize> {
    pub(crate) x: VectorBatch<N>,
    pub(crate) y: VectorBatch<N>,
    pub(crate) z: VectorBatch<N>,
    pub(crate) at: VectorBatch<N>,
}

impl<const N: usize> FrameBatch<N> {
    /// The base.
    pub(crate) const BASE: Self = FrameBatch {
        x: [[1.0; N], [0.0; N], [0.0; N]],
        y: [[0.0; N], [1.0; N], [0.0; N]],
        z: [[0.0; N], [0.0; N], [1.0; N]],
        at: [[0.0; N]; 3],
    };

    /// A frame that is the same in all configurations.
    #[inline(always)]
    pub(crate) fn from_pose(pose: &Pose) -> Self {
        let column = |k: usize| [0, 1, 2].map(|row| [pose.rotation[(row, k)]; N]);
        let at = [0, 1, 2].map(|row| [pose.translation[row]; N]);
        FrameBatch { x: column(0), y: column(1), z: column(2), at }
    }

    /// Changes them to frames whose origin is in their coordinates, and which are turned about x by an angle with this cosine and sine.
    #[inline(always)]
    pub(crate) fn tilt(&mut self, origin: &nalgebra::Vector3<f64>, (c, s): (f64, f64)) {
        for l in 0..N {
            for k in 0..3 {
                let (x, y, z) = (self.x[k][l], self.y[k][l], self.z[k][l]);
                self.at[k][l] += x * origin.x + y * origin.y + z * origin.z;
                self.y[k][l] = y * c + z * s;
                self.z[k][l] = z * c - y * s;
            }
        }
    }

    /// Changes them to frames in their own coordinates.
    #[inline(always)]
    pub(crate) fn advance(&mut self, to: &Pose) {
        let (r, t) = (&to.rotation, &to.translation);
        for l in 0..N {
            for k in 0..3 {
                let (x, y, z) = (self.x[k][l], self.y[k][l], self.z[k][l]);
                self.at[k][l] += x * t.x + y * t.y + z * t.z;
                self.x[k][l] = x * r[(0, 0)] + y * r[(1, 0)] + z * r[(2, 0)];
                self.y[k][l] = x * r[(0, 1)] + y * r[(1, 1)] + z * r[(2, 1)];
                self.z[k][l] = x * r[(0, 2)] + y * r[(1, 2)] + z * r[(2, 2)];
            }
        }
    }

    /// Turns them about their own z.
    #[inline(always)]
    pub(crate) fn turn_by(&mut self, [c, s]: &[NumberBatch<N>; 2]) {
        for l in 0..N {
            for k in 0..3 {
                let (x, y) = (self.x[k][l], self.y[k][l]);
                self.x[k][l] = x * c[l] + y * s[l];
                self.y[k][l] = y * c[l] - x * s[l];
            }
        }
    }

    /// Translates them along their own z.
    #[inline(always)]
    pub(crate) fn slide(&mut self, by: &NumberBatch<N>) {
        let z = self.z;
        add_times(&mut self.at, &z, by);
    }

    /// Directions or, with a share of the origin, positions in their coordinates.
    #[inline(always)]
    pub(crate) fn act(&self, place: [f64; 3], share: f64) -> VectorBatch<N> {
        let mut out = [[0.0; N]; 3];
        for l in 0..N {
            for k in 0..3 {
                out[k][l] = (self.x[k][l] * place[0] + self.y[k][l] * place[1] + self.z[k][l] * place[2])
                    + self.at[k][l] * share;
            }
        }
        out
    }

    /// The frame of one configuration.
    #[inline(always)]
    pub(crate) fn pose(&self, l: usize) -> Pose {
        let column = |of: &VectorBatch<N>| nalgebra::Vector3::new(of[0][l], of[1][l], of[2][l]);
        let rotation = nalgebra::Matrix3::from_columns(&[column(&self.x), column(&self.y), column(&self.z)]);
        Pose::new(rotation, column(&self.at))
    }
}
