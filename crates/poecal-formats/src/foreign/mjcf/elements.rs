//! Elements in messages, and directions.

use nalgebra::{Unit, Vector3};
use roxmltree::Node;

/// Name of an element in messages.
pub(crate) fn describe_element(node: Node<'_, '_>) -> String {
    let tag = node.tag_name().name();
    match node.attribute("name") {
        Some(name) => format!("<{tag}> `{name}`"),
        None => format!("a <{tag}> without name"),
    }
}

pub(crate) fn unit(direction: [f64; 3]) -> Option<Unit<Vector3<f64>>> {
    Unit::try_new(Vector3::from(direction), 1e-12)
}
