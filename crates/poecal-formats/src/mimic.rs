//! Mimic joints, resolved to their readings.

use std::collections::BTreeSet;

use poecal_model::robot::Reading;
use poecal_numerics::error::{Error, Result};

/// The reading of a joint, through any number of leaders; `follows` returns the relation of a joint to its leader. If the leaders form a loop,
/// `circle` makes the error from the sentence on it.
pub(crate) fn reading(
    joint: &str,
    follows: impl Fn(&str) -> Result<Option<Reading>>,
    circle: impl FnOnce(String) -> Error,
) -> Result<Reading> {
    let mut reading = Reading::from_name(joint);
    let mut seen = BTreeSet::from([joint.to_owned()]);
    while let Some(leader) = follows(&reading.name)? {
        if !seen.insert(leader.name.clone()) {
            return Err(circle(format!(
                "joint `{joint}` mimics itself through its leaders, expected a leader that is measured"
            )));
        }
        reading.offset += reading.multiplier * leader.offset;
        reading.multiplier *= leader.multiplier;
        reading.name = leader.name;
    }
    Ok(reading)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poecal_numerics::error::ErrorKind;

    #[test]
    fn a_leader_may_follow_another() {
        let follows = |joint: &str| {
            Ok(match joint {
                "c" => Some(Reading { name: "b".into(), multiplier: 2.0, offset: 1.0 }),
                "b" => Some(Reading { name: "a".into(), multiplier: 3.0, offset: 0.5 }),
                _ => None,
            })
        };
        // c = 2 b + 1 = 2 (3 a + 0.5) + 1
        assert_eq!(
            reading("c", follows, |message| Error::new(ErrorKind::Model, message)),
            Ok(Reading { name: "a".into(), multiplier: 6.0, offset: 2.0 })
        );
    }
}
