//! Names of frames, and texts of elements.

use roxmltree::Node;

/// The frame around the model.
pub(crate) const WORLD: &str = "world";

/// A model's own frame.
pub(crate) const MODEL: &str = "__model__";

/// An element's text, without comments within.
pub(crate) fn text_of(node: Node<'_, '_>) -> String {
    let texts: String = node.children().filter(Node::is_text).filter_map(|it| it.text()).collect();
    texts.trim().to_owned()
}
