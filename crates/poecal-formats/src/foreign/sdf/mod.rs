//! Gazebo's model. Links, joints, frames and models within the model each have a pose in another one; the poses of joints in links follow.

mod frames;
mod joints;
mod words;

use std::path::Path;

use roxmltree::Node;

use super::links::LinkTree;
use crate::unread_elements;
use frames::SdfFrames;
use poecal_numerics::error::Result;
use poecal_storage::xml::{XmlSource, declare_prefixes, parsed};
use words::{MODEL, WORLD, text_of};

/// Expected model, in errors.
const EXPECTED: &str = "a model of Gazebo (SDF)";

/// The links; frames of these names are links too.
pub(crate) fn read(text: &str, path: &Path, named: &[&str]) -> Result<LinkTree> {
    let text = declare_prefixes(text);
    let document = parsed(&text, path, EXPECTED)?;
    let source = XmlSource { document: &document, path };
    let root = document.root_element();
    let model = the_model(source, root)?;
    if let Some(node) = model.descendants().find(|node| node.has_tag_name("include") && !is_of_plugin(*node)) {
        let message = "found <include>, expected a model in one file: `gz sdf --print FILE` writes it whole";
        return Err(source.syntax_error(node, message));
    }
    let version = root.attribute("version").and_then(|it| it.split_once('.')?.1.parse::<u32>().ok()).unwrap_or(12);
    let unread = unread_elements::sentence(&source, root, unread_elements::SDF)?;
    let mut links =
        SdfFrames::from_model(source, model)?.links(model.attribute("name").unwrap_or("robot"), version, named)?;
    links.unread = unread;
    Ok(links)
}

/// The model that has joints.
fn the_model<'a>(source: XmlSource<'a>, root: Node<'a, 'a>) -> Result<Node<'a, 'a>> {
    let worlds = source.children(root, "world").flat_map(|world| source.children(world, "model"));
    let models: Vec<Node<'a, 'a>> = source.children(root, "model").chain(worlds).collect();
    let moves = |model: &&Node<'a, 'a>| model.descendants().any(|it| it.has_tag_name("joint"));
    let moving: Vec<&Node<'a, 'a>> = models.iter().filter(moves).collect();
    match moving.as_slice() {
        [model] => Ok(**model),
        [] => Err(source.syntax_error(root, "found no <model> with a <joint>, expected one")),
        [_, second, ..] => {
            let message =
                format!("found {} models with joints, expected one: keep the arm's alone in a file", moving.len());
            source.refuse(**second, message)
        }
    }
}

/// True if an element belongs to a plugin, which may have any content.
fn is_of_plugin(node: Node<'_, '_>) -> bool {
    node.ancestors().any(|it| it.has_tag_name("plugin"))
}
