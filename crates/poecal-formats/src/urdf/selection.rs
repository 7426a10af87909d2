//! Selection of the joints and links of a URDF that are read.

use poecal_model::robot::{Mount, Robot};
use poecal_numerics::error::{ErrorKind, Result};

/// Selection of a chain, or of a tree. An omitted end must be unique: the base is then the root above the tip, and the tip the only end link
/// below a moving joint.
///
/// With instruments and targets on named links, the robot is the tree of all joints between the base and these links and the tip. If the tip is not
/// selected, it is the first target's link that a joint moves.
///
/// ```
/// let selection = poecal_formats::urdf::ChainSelection { tip_link: Some("tool0".into()), ..Default::default() };
/// assert!(selection.base_link.is_none());
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ChainSelection {
    /// First link of the chain.
    pub base_link: Option<String>,
    /// Last link of the chain.
    pub tip_link: Option<String>,
    /// Names of instruments on the robot, each with its link.
    pub instruments: Vec<(String, String)>,
    /// Names of targets on any link, each with it.
    pub targets: Vec<(String, String)>,
}

impl ChainSelection {
    /// The selection that yields a robot, by its links: the tip's, then those of instruments and targets.
    pub(crate) fn from_links(robot: &Robot, links: &[&str]) -> Self {
        let mut links = links.iter().map(|&link| link.to_owned());
        let tip_link = links.next();
        let mut named = |mounts: &[Mount]| -> Vec<(String, String)> {
            mounts.iter().map(|mount| mount.name.clone()).zip(links.by_ref()).collect()
        };
        let (instruments, targets) = (named(&robot.instruments), named(&robot.mounted));
        ChainSelection { base_link: Some(robot.base_name.clone()), tip_link, instruments, targets }
    }

    /// This selection with further instruments and targets, such as those of a mapping file.
    ///
    /// # Errors
    /// [`ErrorKind::Option`] if one of them has two links.
    pub fn join(mut self, instruments: &[(String, String)], targets: &[(String, String)]) -> Result<Self> {
        for (what, ours, further) in
            [("instrument", &mut self.instruments, instruments), ("target", &mut self.targets, targets)]
        {
            let all = std::mem::take(ours).into_iter().chain(further.iter().cloned());
            for (name, link) in all {
                match ours.iter().find(|(known, _)| *known == name) {
                    Some((_, known)) if *known != link => {
                        return ErrorKind::Option.refuse(format!(
                            "found {what} `{name}` on link `{known}` and on link `{link}`, expected one link"
                        ));
                    }
                    Some(_) => {}
                    None => ours.push((name, link)),
                }
            }
        }
        Ok(self)
    }
}

/// Parses `NAME=LINK`.
///
/// # Errors
/// [`ErrorKind::Option`] if it is not of this form.
pub fn named_link(text: &str) -> Result<(String, String)> {
    match text.split_once('=') {
        Some((name, link)) if !name.trim().is_empty() && !link.trim().is_empty() => {
            Ok((name.trim().to_owned(), link.trim().to_owned()))
        }
        _ => ErrorKind::Option.refuse(format!("found `{text}`, expected a name and its link, like camera=camera_link")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_may_be_named_twice_but_not_two_links() {
        let on = |link: &str| vec![("camera".to_owned(), link.to_owned())];
        let typed = ChainSelection { instruments: on("head"), ..ChainSelection::default() };
        assert_eq!(typed.clone().join(&on("head"), &[]).unwrap(), typed);
        assert_eq!(
            typed.join(&on("hand"), &[]).unwrap_err().to_string(),
            "found instrument `camera` on link `head` and on link `hand`, expected one link"
        );
    }
}
