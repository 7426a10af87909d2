//! What to command so that an arm as it is has its tip where one like its drawing would have it.

use nalgebra::{Matrix3, Vector3};

use crate::arm::Arm;
use crate::lie::Pose;
use crate::newton::{Left, REACHED};
use crate::placed::{MOST_JOINTS, Placed};
use crate::small;

// The functions of numbers, where there is no standard library.
#[allow(unused_imports)]
use nalgebra::{ComplexField as _, RealField as _};

/// How far a joint may move from where its reading and its fitted zero have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MostChange {
    /// Of joints that turn, rad.
    pub turning_rad: f64,
    /// Of joints that slide, m.
    pub sliding_m: f64,
}

impl Default for MostChange {
    /// 2°, 2 mm.
    fn default() -> Self {
        MostChange { turning_rad: 2_f64.to_radians(), sliding_m: 2e-3 }
    }
}

/// What became of a configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The tip is where it was meant.
    Reached,
    /// Its point is, its orientation is not: near a singularity the joints would have to move too far.
    Turned,
    /// The arm cannot have the tip there, as one of fewer than six joints mostly cannot: this is the nearest configuration.
    Nearest,
    /// The joint of this index would have to move by so much (rad, m) beyond its zero; nothing is changed.
    TooFar(usize, f64),
}

/// A corrected configuration's remainder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// What became of it.
    pub outcome: Outcome,
    /// Distance that is left, metres.
    pub left_m: f64,
    /// Angle that is left, radians.
    pub left_rad: f64,
}

/// Corrections of an arm's readings: those with which the actual arm has its tip where the nominal one has it,
/// `actual(q) = nominal(q₀)`, on the branch of `q₀`: no joint moves by more than [`MostChange`] from `q₀ + z`, where `z` are the zeros of the
/// actual arm's joints. Near a singularity, where the pose would take more, the tip's point is exact, and of its rotation is left what cannot
/// be had.
///
/// ```
/// use nalgebra::Vector3;
/// use poecal_arm::{Arm, Corrections, MostChange, Outcome, lie::{Pose, Screw}};
/// let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
/// let arm = |tilt: f64| {
///     let axes = [(z, z * 0.0), (y, z * 0.0), (y, z * 0.4), (x, z * 0.4), (y + z * tilt, z * 0.4 + x * 0.4), (x, z * 0.4)];
///     let screws = axes.map(|(direction, point)| Screw::revolute(&direction.normalize(), &point));
///     Arm::new(&screws, &Pose::from_translation(x * 0.5 + z * 0.4)).unwrap()
/// };
/// let corrections = Corrections::new(&arm(0.0), &arm(1e-3), MostChange::default()).unwrap();
/// let meant = [0.1, 0.2, 0.3, 0.4, 0.0, 0.6];
/// let mut q = meant;
/// let found = corrections.correct(&meant, None, &mut q);
/// assert!(found.left_m < 1e-12 && q.iter().zip(meant).all(|(to, from)| (to - from).abs() < 0.01));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Corrections {
    nominal: Arm,
    actual: Arm,
    zeros: [f64; MOST_JOINTS],
    most: MostChange,
    /// Smallest singular value below which a configuration is near a singularity: the usual one.
    singular: f64,
}

impl Corrections {
    /// Of two arms with the same joints; `None` if their numbers or kinds differ.
    #[must_use]
    pub fn new(nominal: &Arm, actual: &Arm, most: MostChange) -> Option<Self> {
        let kinds = |arm: &Arm, joint: usize| arm.screws()[joint].is_prismatic();
        if nominal.joints() != actual.joints()
            || (0..actual.joints()).any(|joint| kinds(nominal, joint) != kinds(actual, joint))
        {
            return None;
        }
        let zeros = zeros(nominal, actual);
        let mut sizes: [f64; CONFIGURATIONS as usize] = core::array::from_fn(|row| {
            actual.smallest_singular_value(&configuration(nominal, row as u32)[..actual.joints()])
        });
        sizes.sort_unstable_by(f64::total_cmp);
        let singular = sizes[sizes.len() / 2];
        Some(Corrections { nominal: nominal.clone(), actual: actual.clone(), zeros, most, singular })
    }

    /// The nominal arm.
    #[must_use]
    pub fn nominal(&self) -> &Arm {
        &self.nominal
    }

    /// The actual arm.
    #[must_use]
    pub fn actual(&self) -> &Arm {
        &self.actual
    }

    /// Zeros of the actual arm's joints (rad, m): what is added to all readings so that its tip is nearest to that of the nominal one, by
    /// least squares over configurations within the limits.
    #[must_use]
    pub fn zeros(&self) -> &[f64] {
        &self.zeros[..self.actual.joints()]
    }

    /// How far joints may move from their zeros.
    #[must_use]
    pub fn most(&self) -> MostChange {
        self.most
    }

    /// The most of a joint.
    fn most_of(&self, joint: usize) -> f64 {
        if self.actual.screws()[joint].is_prismatic() { self.most.sliding_m } else { self.most.turning_rad }
    }

    /// Takes `q` to the readings of the actual arm for those `meant` for the nominal one (rad, m). The search begins with changes that are
    /// expected, if they are given, and else with the zeros.
    pub fn correct(&self, meant: &[f64], expected: Option<&[f64]>, q: &mut [f64]) -> Correction {
        self.correct_to(&self.nominal.forward_kinematics(meant), meant, expected, q)
    }

    /// The same, of the nominal arm's tip at `meant`.
    pub fn correct_to(
        &self,
        target: &Pose,
        meant: &[f64],
        expected: Option<&[f64]>,
        q: &mut [f64],
    ) -> Correction {
        let n = self.actual.joints().min(q.len()).min(meant.len());
        let (q, meant) = (&mut q[..n], &meant[..n]);
        let mut farthest = None;
        if let Some(expected) = expected {
            q.iter_mut().zip(meant.iter().zip(expected)).for_each(|(q, (meant, by))| *q = meant + by);
            if let Some(found) = self.exact(target, meant, q, &mut farthest) {
                return found;
            }
        }
        self.begin(meant, q);
        if let Some(found) = self.exact(target, meant, q, &mut farthest) {
            return found;
        }
        if n < 6 {
            return self.kept(target, meant, q, farthest);
        }
        let mut near = [0.0; MOST_JOINTS];
        near[..n].copy_from_slice(q);
        self.begin(meant, q);
        if let Some(left_rad) = self.point(target, meant, q) {
            let (left_m, _) = self.left(target, q);
            return Correction { outcome: Outcome::Turned, left_m, left_rad };
        }
        q.copy_from_slice(&near[..n]);
        self.kept(target, meant, q, farthest)
    }

    /// Takes `q` to where zeros alone have it.
    fn begin(&self, meant: &[f64], q: &mut [f64]) {
        q.iter_mut().zip(meant.iter().zip(&self.zeros)).for_each(|(q, (meant, zero))| *q = meant + zero);
    }

    fn left(&self, target: &Pose, q: &[f64]) -> (f64, f64) {
        self.actual.forward_kinematics(q).apart(target)
    }

    /// The joint that is farthest beyond what it may move, and its change.
    fn farthest(&self, meant: &[f64], q: &[f64]) -> Option<(usize, f64)> {
        let mut worst: Option<(usize, f64)> = None;
        for (joint, (q, meant)) in q.iter().zip(meant).enumerate() {
            let change = (q - meant - self.zeros[joint]).abs();
            let over = change / self.most_of(joint);
            // Not a number is too far as well.
            let is_too_far = over.is_nan() || over > 1.0 + 1e-9;
            if is_too_far && worst.is_none_or(|(other, it)| over > it / self.most_of(other)) {
                worst = Some((joint, change));
            }
        }
        worst
    }

    /// The largest change of a joint beyond its zero, over what is allowed.
    #[must_use]
    pub fn share_of_most(&self, meant: &[f64], q: &[f64]) -> f64 {
        let shares = q.iter().zip(meant).zip(&self.zeros).enumerate();
        shares
            .map(|(joint, ((q, meant), zero))| (q - meant - zero).abs() / self.most_of(joint))
            .fold(0.0, f64::max)
    }

    /// The configuration that has the pose, if it is on this branch; keeps what is too far.
    fn exact(
        &self,
        target: &Pose,
        meant: &[f64],
        q: &mut [f64],
        farthest: &mut Option<(usize, f64)>,
    ) -> Option<Correction> {
        let left = self.actual.nearest(target, q);
        *farthest = self.farthest(meant, q);
        // Both are below their common measure.
        let is_reached = left < REACHED;
        (is_reached && farthest.is_none()).then(|| Correction {
            outcome: Outcome::Reached,
            left_m: left * self.actual.reach_m(),
            left_rad: left,
        })
    }

    /// The nearest configuration of a pose out of reach, or what is too far for it.
    fn kept(
        &self,
        target: &Pose,
        meant: &[f64],
        q: &mut [f64],
        farthest: Option<(usize, f64)>,
    ) -> Correction {
        let outcome = match farthest {
            None => Outcome::Nearest,
            Some((joint, change)) => {
                q.copy_from_slice(meant);
                Outcome::TooFar(joint, change)
            }
        };
        let (left_m, left_rad) = self.left(target, q);
        Correction { outcome, left_m, left_rad }
    }

    /// Takes `q` to a configuration that has the tip's point exactly and its rotation as far as joints may move: of every turn that the arm can
    /// make with the point at rest, a singular one takes `c/s` for a turn by `c`; where that is more than is left of a joint's most change, it
    /// is less the nearer `s` is to 0, and 0 there, so that a smooth motion stays smooth. The angle that is left; `None` if the point cannot be
    /// had, or no singularity is near.
    fn point(&self, target: &Pose, meant: &[f64], q: &mut [f64]) -> Option<f64> {
        let n = q.len();
        let reach = self.actual.reach_m();
        let slides: [bool; MOST_JOINTS] =
            core::array::from_fn(|joint| joint < n && self.actual.screws()[joint].is_prismatic());
        // Steps that slide are counted in reaches, as angles.
        let unit = |joint: usize| if slides[joint] { reach } else { 1.0 };
        let most: [f64; MOST_JOINTS] =
            core::array::from_fn(
                |joint| if joint < n { MARGIN * self.most_of(joint) / unit(joint) } else { 0.0 },
            );
        let at = |q: &[f64]| {
            let placed = self.actual.placed(q);
            let ways = Ways::of(&placed, n, |joint| if slides[joint] { 1.0 } else { 1.0 / reach });
            (Left::new(&placed.tip, target), ways)
        };
        for step in 0..MOST_STEPS {
            let (left, ways) = at(q);
            let mut from = [0.0; MOST_JOINTS];
            for joint in 0..n {
                from[joint] = (q[joint] - meant[joint] - self.zeros[joint]) / unit(joint);
            }
            let to = ways.least(&left, 1.0 / reach, &from[..n], &most[..n])?;
            let mut longest = 0.0_f64;
            for joint in 0..n {
                let by = to[joint] - from[joint];
                longest = longest.max(by.abs());
                q[joint] += by * unit(joint);
            }
            if longest < 1e-9 || (step > 12 && longest < 1e-7) {
                break;
            }
        }
        // The point to the last digits, by the least motion.
        for _ in 0..6 {
            let (left, ways) = at(q);
            if left.position.norm() < POINT * reach {
                break;
            }
            let by = ways.to_point(&(left.position / reach))?;
            for joint in 0..n {
                q[joint] += by[joint] * unit(joint);
            }
        }
        let (left_m, left_rad) = self.left(target, q);
        let is_found = left_m < 10.0 * POINT * reach && left_rad <= self.most.turning_rad;
        let is_kept = is_found && self.farthest(meant, q).is_none();
        (is_kept && self.actual.smallest_singular_value(q) < self.singular).then_some(left_rad)
    }
}

/// Steps to a configuration near a singularity: each leaves some hundredths of the one before.
const MOST_STEPS: u32 = 40;
/// Share of what a joint may move that the search uses: the last digits of the point take some more.
const MARGIN: f64 = 0.999;
/// Distance over the reach below which the tip's point is met.
const POINT: f64 = 1e-13;

/// How an arm moves to first order: with the tip's point at rest, and with it.
struct Ways {
    n: usize,
    /// Motions of the point, over the reach, and turns.
    columns: [(Vector3<f64>, Vector3<f64>); MOST_JOINTS],
    /// (Jₚ Jₚᵀ)⁻¹.
    inverse: Option<Matrix3<f64>>,
}

impl Ways {
    fn of(placed: &Placed<MOST_JOINTS>, n: usize, scale: impl Fn(usize) -> f64) -> Self {
        let columns = core::array::from_fn(|joint| {
            let (v, w) = placed.column(joint);
            if joint < n { (v * scale(joint), w) } else { (Vector3::zeros(), Vector3::zeros()) }
        });
        let mut ways = Ways { n, columns, inverse: None };
        ways.invert();
        ways
    }

    /// Computes (Jₚ Jₚᵀ)⁻¹ of the columns.
    fn invert(&mut self) {
        let mut moves = Matrix3::zeros();
        for (v, _) in &self.columns[..self.n] {
            moves += v * v.transpose();
        }
        self.inverse = moves.try_inverse().filter(|it| it.iter().all(|it| it.is_finite()));
    }

    /// The least motion of the joints that are free that moves the point.
    fn to_point(&self, by: &Vector3<f64>) -> Option<[f64; MOST_JOINTS]> {
        let pull = self.inverse? * by;
        Some(core::array::from_fn(|joint| self.columns[joint].0.dot(&pull)))
    }

    /// A joint that does not move.
    fn hold(&mut self, joint: usize) {
        self.columns[joint] = (Vector3::zeros(), Vector3::zeros());
        self.invert();
    }

    /// Changes from the zeros that take away what is left, from the changes that there are. What a joint cannot do the others do, as far as
    /// they may.
    fn least(
        mut self,
        left: &Left,
        inverse_reach: f64,
        from: &[f64],
        most: &[f64],
    ) -> Option<[f64; MOST_JOINTS]> {
        let n = self.n;
        let (mut point, mut turn) = (left.position * inverse_reach, left.rotation);
        for ((v, w), from) in self.columns.iter().zip(from) {
            point += v * *from;
            turn += w * *from;
        }
        let mut held = [0.0; MOST_JOINTS];
        let mut to = self.to_point(&point)?;
        for _ in 3..n {
            let over = |joint: &usize| to[*joint].abs() / most[*joint];
            let worst = (0..n).max_by(|a, b| over(a).total_cmp(&over(b)))?;
            if over(&worst) <= 1.0 {
                break;
            }
            held[worst] = most[worst] * to[worst].signum();
            let (v, w) = self.columns[worst];
            point -= v * held[worst];
            turn -= w * held[worst];
            self.hold(worst);
            to = self.to_point(&point)?;
        }
        for ((_, w), to) in self.columns[..n].iter().zip(&to) {
            turn -= w * *to;
        }
        // Turns with the point at rest: of each joint what is left of its turn once the others have brought the point back.
        let inverse = self.inverse?;
        let mut across = Matrix3::zeros();
        for (v, w) in &self.columns[..n] {
            across += w * v.transpose();
        }
        let back = across * inverse;
        let mut turns = [Vector3::zeros(); MOST_JOINTS];
        let mut gram = Matrix3::zeros();
        for ((v, w), turn) in self.columns[..n].iter().zip(&mut turns) {
            *turn = w - back * v;
            gram += *turn * turn.transpose();
        }
        let eigen = gram.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_unstable_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        for at in order {
            let direction = eigen.eigenvectors.column(at).into_owned();
            let size = eigen.eigenvalues[at].max(0.0).sqrt();
            let wanted = turn.dot(&direction);
            if size < 1e-9 {
                continue;
            }
            let way: [f64; MOST_JOINTS] = core::array::from_fn(|joint| turns[joint].dot(&direction) / size);
            let mut room = f64::INFINITY;
            for joint in 0..n {
                if way[joint].abs() > 1e-12 {
                    room = room.min((most[joint] - to[joint].abs()).max(0.0) / way[joint].abs());
                }
            }
            let exact = wanted / size;
            let along = if exact.abs() <= room {
                exact
            } else {
                // Continuous where it is just in reach, and 0 at the singularity.
                let share = room / exact.abs();
                room * exact.signum() * 2.0 * share / (1.0 + share * share)
            };
            to.iter_mut().zip(way).for_each(|(to, way)| *to += along * way);
        }
        to.iter_mut().zip(held).for_each(|(to, held)| *to += held);
        Some(to)
    }
}

/// Configurations by which zeros are fitted.
const CONFIGURATIONS: u32 = 48;
/// A joint without limits turns by half a turn to each side, or slides by so much (m).
const SLIDE: f64 = 0.5;

/// One of the configurations, within an arm's limits.
fn configuration(arm: &Arm, row: u32) -> [f64; MOST_JOINTS] {
    core::array::from_fn(|joint| {
        let Some(&(low, high)) = arm.limits().get(joint) else { return 0.0 };
        let wide = if arm.screws()[joint].is_prismatic() { SLIDE } else { core::f64::consts::PI };
        let (low, high) = (low.max(-wide).min(wide), high.min(wide).max(-wide));
        low + (high - low) * radical_inverse(row + 1, PRIMES[joint])
    })
}

/// Zeros of the actual arm's joints, by least squares (Levenberg and Marquardt); none if these do not converge.
fn zeros(nominal: &Arm, actual: &Arm) -> [f64; MOST_JOINTS] {
    let n = actual.joints();
    let reach = actual.reach_m();
    let unit = |joint: usize| if actual.screws()[joint].is_prismatic() { reach } else { 1.0 };
    // Sums of all configurations at some zeros: the normal equations, and the squares.
    let at = |zeros: &[f64; MOST_JOINTS]| {
        let (mut a, mut b, mut squares) = ([[0.0; MOST_JOINTS]; MOST_JOINTS], [0.0; MOST_JOINTS], 0.0);
        for row in 0..CONFIGURATIONS {
            let meant = configuration(nominal, row);
            let q: [f64; MOST_JOINTS] = core::array::from_fn(|joint| meant[joint] + zeros[joint]);
            let placed = actual.placed(&q[..n]);
            let left = Left::new(&placed.tip, &nominal.forward_kinematics(&meant[..n]));
            let (p, w) = (left.position / reach, left.rotation);
            squares += p.norm_squared() + w.norm_squared();
            let columns: [(Vector3<f64>, Vector3<f64>); MOST_JOINTS] = core::array::from_fn(|joint| {
                if joint >= n {
                    return (Vector3::zeros(), Vector3::zeros());
                }
                let (v, w) = placed.column(joint);
                (v * (unit(joint) / reach), w * unit(joint))
            });
            for i in 0..n {
                for j in 0..n {
                    a[i][j] += columns[i].0.dot(&columns[j].0) + columns[i].1.dot(&columns[j].1);
                }
                b[i] += columns[i].0.dot(&p) + columns[i].1.dot(&w);
            }
        }
        (a, b, squares)
    };
    let mut zeros = [0.0; MOST_JOINTS];
    let (mut a, mut b, mut squares) = at(&zeros);
    let mut damping = 1e-9;
    for _ in 0..50 {
        let (mut damped, mut step) = (a, b);
        for (joint, row) in damped.iter_mut().enumerate().take(n) {
            row[joint] += damping * f64::from(CONFIGURATIONS);
        }
        if small::solve_symmetric(&mut damped, &mut step, n).is_none() {
            return [0.0; MOST_JOINTS];
        }
        let longest = step.iter().fold(0.0_f64, |most, it| most.max(it.abs()));
        let next: [f64; MOST_JOINTS] =
            core::array::from_fn(
                |joint| if joint < n { zeros[joint] + step[joint] * unit(joint) } else { 0.0 },
            );
        let there = at(&next);
        if there.2 < squares {
            zeros = next;
            (a, b, squares) = there;
            damping = (damping * 0.1).max(1e-12);
        } else {
            damping = (damping * 10.0).max(1e-9);
        }
        if longest < 1e-12 || damping > 1e3 {
            break;
        }
    }
    zeros
}

const PRIMES: [u32; MOST_JOINTS] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];

/// The digits of a number behind the point, the last one first (halton1960).
fn radical_inverse(mut number: u32, base: u32) -> f64 {
    let (mut out, mut digit) = (0.0, 1.0 / f64::from(base));
    while number > 0 {
        out += f64::from(number % base) * digit;
        number /= base;
        digit /= f64::from(base);
    }
    out
}
