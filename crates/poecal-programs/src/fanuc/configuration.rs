//! The configuration of a position: `CONFIG : 'N U T, 0, 0, 0'`.

use std::f64::consts::TAU;

use poecal_arm::Arm;

use super::super::parsed_program::Number;
use super::super::posture::{MARGIN, Posture};
use super::super::scan::{Token, signed_number};

/// Letters and turn numbers of a configuration.
///
/// `N` (no flip) and `F` (flip) state the sign of the fifth joint, negative and positive. Negative angles bend the hand down on an arm with a
/// horizontal forearm to the front. `T` (toward, front) and `B` (back) state the side of the first axis on which the wrist centre is. `U` (up) and
/// `D` (down) state whether the elbow is above the line from shoulder to wrist. With the wrist at the back, the upper one of the two elbows is
/// ambiguous: there, `U` and `D` are not checked. A joint with turn number t is within half a turn of t turns. The turn numbers are of joints 1, 4
/// and 6 or of joints 4, 5 and 6, by the setup of the controller: both are tried.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FanucConfiguration {
    is_flipped: bool,
    is_up: bool,
    is_front: bool,
    turns: [i32; 3],
}

/// Joints of the turn numbers, from 0.
const ORDERS: [[usize; 3]; 2] = [[0, 3, 5], [3, 4, 5]];

impl FanucConfiguration {
    /// The configuration in quotes, with its turn numbers.
    pub(crate) fn read(text: &[u8], tokens: &[Token]) -> Option<(Self, Vec<Number>)> {
        let mut parts = tokens.split(|it| it.is(b','));
        let mut letters = (None, None, None);
        for letter in parts.next()? {
            let place = match letter.text(text).to_ascii_uppercase().as_str() {
                "N" => (&mut letters.0, false),
                "F" => (&mut letters.0, true),
                "U" => (&mut letters.1, true),
                "D" => (&mut letters.1, false),
                "T" => (&mut letters.2, true),
                "B" => (&mut letters.2, false),
                // Other words belong to other arms.
                _ => return None,
            };
            if place.0.replace(place.1).is_some() {
                return None;
            }
        }
        let numbers: Vec<Number> = parts.map(signed_number).collect::<Option<_>>()?;
        let turns: Vec<i32> = numbers.iter().map(|it| it.value as i32).collect();
        let is_whole = numbers.iter().all(|it| it.value.fract() == 0.0 && it.value.abs() < 100.0);
        let turns: [i32; 3] = turns.try_into().ok().filter(|_| is_whole)?;
        let (Some(is_flipped), Some(is_up), Some(is_front)) = letters else { return None };
        Some((FanucConfiguration { is_flipped, is_up, is_front, turns }, numbers))
    }

    /// True if a configuration of the nominal arm (rad) fits, borders included; false for an arm with another structure.
    pub(crate) fn fits(&self, nominal: &Arm, q: &[f64], counted: &[f64]) -> bool {
        self.letters(nominal, q) && self.orders(nominal).any(|order| self.turns_off(order, counted) < MARGIN)
    }

    /// True if the letters fit.
    fn letters(&self, nominal: &Arm, q: &[f64]) -> bool {
        let Ok(q) = <&[f64; 6]>::try_from(q) else { return false };
        let Some(posture) = Posture::new(nominal).filter(Posture::is_down_negative) else { return false };
        let bent = posture.bends_at(q);
        let agrees = |found: Option<bool>, stated: bool| found.is_none_or(|it| it == stated);
        agrees(bent.is_wrist_positive, self.is_flipped)
            && agrees(bent.is_front, self.is_front)
            && (!self.is_front || agrees(bent.is_before_arm, self.is_up))
    }

    /// The largest distance (rad) of a joint beyond the half turns of its turn number.
    fn turns_off(&self, order: &[usize; 3], q: &[f64]) -> f64 {
        let off = |(&joint, &turns): (&usize, &i32)| {
            let value = q.get(joint).copied().unwrap_or(f64::INFINITY);
            (value - f64::from(turns) * TAU).abs() - 0.5 * TAU
        };
        order.iter().zip(&self.turns).map(off).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The orders of turn numbers that are possible within limits.
    fn orders(&self, nominal: &Arm) -> impl Iterator<Item = &'static [usize; 3]> {
        let limits = nominal.limits();
        ORDERS.iter().filter(move |order| {
            order.iter().zip(&self.turns).all(|(&joint, &turns)| {
                let (low, high) = limits.get(joint).copied().unwrap_or((0.0, 0.0));
                let middle = f64::from(turns) * TAU;
                low < middle + 0.5 * TAU - MARGIN && high > middle - 0.5 * TAU + MARGIN
            })
        })
    }

    /// The turn numbers at a configuration of the nominal arm (rad); `None` if letters change, or if the turn number that changes is ambiguous.
    pub(crate) fn words(&self, nominal: &Arm, q: &[f64], counted: &[f64]) -> Option<Vec<f64>> {
        let mut is_possible = false;
        for order in self.orders(nominal) {
            is_possible = true;
            if self.turns_off(order, counted) > 0.0 {
                return None;
            }
        }
        let turns = self.turns.iter().map(|it| f64::from(*it)).collect();
        (is_possible && self.letters(nominal, q)).then_some(turns)
    }
}
