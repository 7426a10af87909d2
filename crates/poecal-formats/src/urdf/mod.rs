//! URDF: reads a serial chain, or the tree of joints that move named links, and writes calibrated values into the same text.
//!
//! It reads links, joints (fixed, revolute, continuous, prismatic), origins, axes, limits and mimic relations. Everything else in the
//! file (meshes, inertias, controllers, comments) is ignored and stays.

mod chain;
mod doubts;
mod ends;
mod origins;
mod patch;
mod selection;
mod splice;
mod terms;
mod tree;
mod urdf_joints;
mod visuals;
mod write;

use std::path::{Path, PathBuf};

pub use doubts::doubts;
pub use origins::UrdfOrigin;
pub use patch::{PatchedUrdf, origin_values};
pub use selection::{ChainSelection, named_link};
pub use splice::escape_attribute;
pub use terms::holdable;
pub use visuals::{Geometry, Visual};
pub use write::{ConvertedModel, write_new, written_new};
pub(crate) use write::{UrdfText, WIDE_LIMITS};

use crate::unread_elements;
use poecal_arm::lie::Pose;
use poecal_model::robot::Robot;
use poecal_numerics::error::Result;
use poecal_storage::source_text;
use poecal_storage::xml::{XmlSource, declare_prefixes, parsed};
use tree::UrdfTree;
use urdf_joints::{NamedLink, UrdfJoint};

/// A URDF text with its serial chain, or its tree of the joints that move named links.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfDocument {
    text: String,
    path: PathBuf,
    robot: Robot,
    parts: Vec<UrdfJoint>,
    /// The tip's link, then those of instruments and targets, in the robot's order.
    ends: Vec<NamedLink>,
    /// Pose in the base of the link from which the chain leads down: the base itself, or a link connected to it by fixed joints.
    base_from_top: Pose,
    beyond: Vec<(String, String)>,
    made_from: Option<&'static str>,
    remarks: Vec<String>,
}

impl UrdfDocument {
    /// Reads a URDF file.
    ///
    /// # Errors
    /// `ErrorKind::File` if the file cannot be read, and those of [`UrdfDocument::parse`].
    pub fn read(path: impl AsRef<Path>, selection: &ChainSelection) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&source_text::read(path, "a URDF robot description")?, path, selection)
    }

    /// Reads the chain or tree from a text; `path` is for the messages only.
    ///
    /// # Errors
    /// `ErrorKind::Syntax` if the text is no XML or no URDF, `ErrorKind::Model` if it is not a tree of links, the chain is not unique
    /// or missing, or a joint of it is invalid.
    pub fn parse(text: &str, path: impl AsRef<Path>, selection: &ChainSelection) -> Result<Self> {
        Self::parse_at(text, path.as_ref(), selection)
    }

    /// Compiled once, and not for each kind of path.
    fn parse_at(text: &str, path: &Path, selection: &ChainSelection) -> Result<Self> {
        let readable = declare_prefixes(text);
        let document = parsed(&readable, path, EXPECTED)?;
        let source = XmlSource { document: &document, path };
        let robot_element = document.root_element();
        if robot_element.tag_name().name() != "robot" {
            let name = robot_element.tag_name().name();
            let message = match name {
                "mujoco" | "sdf" => format!(
                    "found root element <{name}>, expected <robot>, as in every URDF file: `poecal export CALIBRATION --format {}` writes this \
                     form",
                    if name == "sdf" { "sdf" } else { "mjcf" }
                ),
                _ => format!("found root element <{name}>, expected <robot>, as in every URDF file"),
            };
            return Err(source.syntax_error(robot_element, message));
        }
        refuse_xacro(&source)?;
        let unread = unread_elements::sentence(&source, robot_element, unread_elements::URDF)?;
        let tree = UrdfTree::read(source)?;
        let chain = chain::select(&tree, selection)?;
        let name = robot_element.attribute("name").filter(|name| !name.trim().is_empty()).unwrap_or("robot");
        let (parts, ends, robot, base_from_top) = urdf_joints::read(&tree, &chain, name)?;
        let remarks = unread.into_iter().chain(urdf_joints::remarks(&parts)).collect();
        Ok(UrdfDocument {
            text: text.to_owned(),
            path: path.to_path_buf(),
            robot,
            parts,
            ends,
            base_from_top,
            beyond: ends::joints_beyond(&tree, chain.tip),
            made_from: None,
            remarks,
        })
    }

    /// The robot of the chain; frames and screws are in the base link.
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// The selection that yields this robot from this text: base, tip, instruments and targets with their links.
    #[must_use]
    pub fn selection(&self) -> ChainSelection {
        let links: Vec<&str> = self.ends.iter().map(|end| end.link.as_str()).collect();
        ChainSelection::from_links(&self.robot, &links)
    }

    /// Joints beyond the tip link, which are not part of the robot, each with an end link that it moves.
    #[must_use]
    pub fn joints_beyond_tip(&self) -> &[(String, String)] {
        &self.beyond
    }

    /// The document with the form of another file from which it was made.
    pub(crate) fn made_from(self, form: &'static str, unread: Option<String>) -> Self {
        UrdfDocument { made_from: Some(form), remarks: unread.into_iter().collect(), ..self }
    }

    /// Contents on links and joints that are not read, or that other readers understand differently, a sentence each; contents that scale or shift
    /// are refused.
    #[must_use]
    pub fn remarks(&self) -> &[String] {
        &self.remarks
    }

    /// The form of the file that was read: `URDF`, or the one from which this text was made.
    #[must_use]
    pub fn form(&self) -> &'static str {
        self.made_from.unwrap_or("URDF")
    }

    /// The original text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }
}

const EXPECTED: &str = "a URDF robot description";
/// Parents of elements that are read, which may add links and joints. Contents of a visual, a sensor or an unknown element are not read.
const READ_IN: [&str; 3] = ["robot", "link", "joint"];

/// An expanded file may still declare the prefix, and have elements of it in parts that are not read.
fn refuse_xacro(source: &XmlSource) -> Result<()> {
    let is_xacro = |node: &roxmltree::Node| {
        let name = node.tag_name();
        name.namespace().is_some_and(|uri| uri.contains("xacro")) || name.name().starts_with("xacro_")
    };
    let is_read = |node: &roxmltree::Node| {
        let mut above = node.ancestors().skip(1).filter(roxmltree::Node::is_element);
        above.all(|it| READ_IN.contains(&it.tag_name().name()))
    };
    let found = source.document.descendants().find(|node| node.is_element() && is_xacro(node) && is_read(node));
    let Some(node) = found else { return Ok(()) };
    let message = if source.document.descendants().any(|it| it.has_tag_name("joint")) {
        "found a xacro element beside joints, expected plain URDF: expand the file with `xacro robot.xacro > robot.urdf`, or, if it is expanded \
         and this element adds no joints, delete it"
    } else {
        "found a xacro element, expected plain URDF: expand the file first with `xacro robot.xacro > robot.urdf`"
    };
    Err(source.syntax_error(node, message.to_owned()))
}
