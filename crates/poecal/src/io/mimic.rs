//! Mimic joints, resolved to their readings.

use std::collections::BTreeSet;

use crate::robot::Reading;

/// A joint that follows another: value = multiplier · leader's value + offset.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mimic {
    pub(super) leader: String,
    pub(super) multiplier: f64,
    pub(super) offset: f64,
}

/// The reading of a joint, through any number of leaders. `None` for a circle of leaders.
pub(super) fn reading<E>(
    joint: &str,
    mut mimic_of: impl FnMut(&str) -> Result<Option<Mimic>, E>,
) -> Result<Option<Reading>, E> {
    let mut reading = Reading::own(joint);
    let mut seen = BTreeSet::from([joint.to_owned()]);
    while let Some(mimic) = mimic_of(&reading.name)? {
        if !seen.insert(mimic.leader.clone()) {
            return Ok(None);
        }
        reading.offset += reading.multiplier * mimic.offset;
        reading.multiplier *= mimic.multiplier;
        reading.name = mimic.leader;
    }
    Ok(Some(reading))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leader_may_follow_another() {
        let mimic_of = |joint: &str| -> Result<Option<Mimic>, ()> {
            Ok(match joint {
                "c" => Some(Mimic { leader: "b".into(), multiplier: 2.0, offset: 1.0 }),
                "b" => Some(Mimic { leader: "a".into(), multiplier: 3.0, offset: 0.5 }),
                _ => None,
            })
        };
        // c = 2 b + 1 = 2 (3 a + 0.5) + 1
        assert_eq!(
            reading("c", mimic_of),
            Ok(Some(Reading { name: "a".into(), multiplier: 6.0, offset: 2.0 }))
        );
    }
}
