//! Status and turn of KRL.

use nalgebra::Vector3;
use poecal_arm::Arm;

use super::super::shape::{axes, wrist_centre};

/// `S` and `T` of a pose, as far as they are stated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status {
    /// Status: bit 0 if the wrist centre is behind axis 1, bit 1 if axis 3 is bent up from the stretched arm, bit 2 if axis 5 is negative.
    pub(crate) status: Option<u32>,
    /// Turn: bit i if axis i + 1 is negative.
    pub(crate) turn: Option<u32>,
}

/// Angle (rad), and distance over the reach, from a border at which the numbers of a program may be rounded to either side.
const BORDER: f64 = 2e-4;

/// A bit of a configuration; `None` at the border, where the program's bit applies.
type StatusBit = Option<bool>;

fn sided(value: f64, border: f64) -> StatusBit {
    (value.abs() > border).then_some(value > 0.0)
}

impl Status {
    /// True if a configuration of the nominal arm has the stated bits; at borders either value is accepted.
    pub(crate) fn fits(&self, nominal: &Arm, q: &[f64], counted: &[f64]) -> bool {
        let fit = |stated: Option<u32>, bits: &[StatusBit]| {
            let Some(stated) = stated else { return true };
            bits.iter().enumerate().all(|(at, bit)| bit.is_none_or(|it| it == (stated >> at & 1 == 1)))
        };
        let turns: Vec<StatusBit> = counted.iter().take(6).map(|it| sided(-it, BORDER)).collect();
        fit(self.turn, &turns) && fit(self.status, &status(nominal, q, BORDER))
    }

    /// The stated numbers for another configuration: further bits of the program are kept.
    pub(crate) fn words(&self, nominal: &Arm, q: &[f64], counted: &[f64]) -> Vec<f64> {
        let with = |stated: u32, bits: &[StatusBit]| {
            let put = |all: u32, (at, bit): (usize, &StatusBit)| match bit {
                Some(true) => all | 1 << at,
                Some(false) => all & !(1 << at),
                None => all,
            };
            f64::from(bits.iter().enumerate().fold(stated, put))
        };
        let turns: Vec<StatusBit> = counted.iter().take(6).map(|it| Some(*it < 0.0)).collect();
        let status = self.status.map(|it| with(it, &status(nominal, q, 0.0)));
        status.into_iter().chain(self.turn.map(|it| with(it, &turns))).collect()
    }
}

/// The three bits of the status of six revolute axes.
fn status(nominal: &Arm, q: &[f64], border: f64) -> [StatusBit; 3] {
    let placed = axes(nominal, q);
    let Some(centre) = wrist_centre(&placed) else { return [None; 3] };
    let [(p1, w1), (p2, _), (p3, w3), ..] = placed[..] else { return [None; 3] };
    let reach = nominal.reach_m();
    // Bit 0: at zero of axis 1, the x axis of its frame is that of the base.
    let turned = poecal_arm::lie::rotation::exp(&(w1 * q[0]));
    let behind = -(turned * Vector3::x()).dot(&(centre - p1)) / reach;
    // Bit 1: side of the stretched arm on which the forearm is; undetermined within the border, or if the sign of axis 3 differs.
    let across = |it: Vector3<f64>| it - w3 * w3.dot(&it);
    let bent = across(p3 - p2).cross(&across(centre - p3)).dot(&w3) / (reach * reach);
    let elbow = match (sided(bent, border), sided(q[2], border)) {
        (Some(one), Some(other)) if one == other => Some(one),
        (bent, _) if border == 0.0 => bent,
        _ => None,
    };
    [sided(behind, border), elbow, sided(-q[4], border)]
}
