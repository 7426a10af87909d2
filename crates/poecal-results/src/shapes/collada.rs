//! COLLADA: triangles and polygons of the geometries in the scene, in metres. As in RViz, the scene is not turned by its stated up axis.

use std::collections::BTreeMap;
use std::path::Path;

use roxmltree::Node;

use super::collector::{Collector, MeshReason, Triangles};
use poecal_storage::xml::parsed;

/// Most levels of nested nodes.
const DEEPEST: usize = 64;

/// The first three rows of a transformation.
type TransformRows = [[f64; 4]; 3];
const STILL: TransformRows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

pub(crate) fn triangles(text: &str, mut into: Collector) -> Result<Triangles, MeshReason> {
    let document = parsed(text, Path::new("mesh"), "COLLADA").map_err(|error| {
        // The sentence without the name of a file, which is stated before.
        error.to_string().lines().next().unwrap_or_default().trim_start_matches("mesh:").trim().to_owned()
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err(format!("found root element <{}>, expected <COLLADA>", root.tag_name().name()));
    }
    let metre =
        children(root, "asset").flat_map(|asset| children(asset, "unit")).find_map(|unit| number(unit, "meter"));
    let metre = metre.filter(|metre| *metre > 0.0).unwrap_or(1.0);
    let mut library = Library::from_root(root);
    let mut instances: Vec<(Node, TransformRows)> = root
        .descendants()
        .filter(|node| is(*node, "instance_geometry"))
        .filter_map(|node| Some((library.find_by_url(node.attribute("url")?)?, place(node)?)))
        .collect();
    if instances.is_empty() {
        instances = root.descendants().filter(|node| is(*node, "geometry")).map(|node| (node, STILL)).collect();
    }
    for (geometry, rows) in instances {
        library.add(geometry, &rows.map(|row| row.map(|value| value * metre)), &mut into)?;
    }
    into.into_triangles()
}

fn is(node: Node, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

fn children<'a>(node: Node<'a, 'a>, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(move |child| is(*child, name))
}

fn number(node: Node, name: &str) -> Option<f64> {
    node.attribute(name)?.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

fn numbers(node: Node) -> Vec<f64> {
    let text = node.text().unwrap_or_default();
    text.split_ascii_whitespace().map(|word| word.parse().unwrap_or(f64::NAN)).collect()
}

/// Elements by their references, and the numbers that were read from them.
struct Library<'a> {
    by_id: BTreeMap<&'a str, Node<'a, 'a>>,
    places: BTreeMap<&'a str, Vec<[f64; 3]>>,
}

impl<'a> Library<'a> {
    fn from_root(root: Node<'a, 'a>) -> Self {
        let by_id = root.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
        Library { by_id, places: BTreeMap::new() }
    }

    fn find_by_url(&self, url: &str) -> Option<Node<'a, 'a>> {
        self.by_id.get(url.strip_prefix('#')?).copied()
    }

    /// Positions of the vertices to which an input of `VERTEX` refers.
    fn places(&mut self, url: &str) -> Option<&[[f64; 3]]> {
        let vertices = self.find_by_url(url)?;
        let position = children(vertices, "input").find(|it| it.attribute("semantic") == Some("POSITION"))?;
        let source = self.find_by_url(position.attribute("source")?)?;
        let id = source.attribute("id")?;
        if !self.places.contains_key(id) {
            let floats = numbers(children(source, "float_array").next()?);
            let accessor = source.descendants().find(|node| is(*node, "accessor"));
            let stride = accessor.and_then(|it| it.attribute("stride")?.parse().ok()).unwrap_or(3).max(3);
            let place = |part: &[f64]| Some([*part.first()?, *part.get(1)?, *part.get(2)?]);
            self.places.insert(id, floats.chunks(stride).filter_map(place).collect());
        }
        self.places.get(id).map(Vec::as_slice)
    }

    /// Adds the faces of a geometry.
    fn add(&mut self, geometry: Node<'a, 'a>, rows: &TransformRows, into: &mut Collector) -> Result<(), MeshReason> {
        let forms = children(geometry, "mesh").flat_map(|mesh| mesh.children());
        for faces in forms.filter(|node| ["triangles", "polylist", "polygons"].iter().any(|it| is(*node, it))) {
            let offset = |input: Node| input.attribute("offset").map_or(Some(0), |it| it.trim().parse::<usize>().ok());
            let inputs: Vec<(Node, usize)> =
                children(faces, "input").filter_map(|input| Some((input, offset(input)?))).collect();
            let vertex = inputs.iter().find(|(input, _)| input.attribute("semantic") == Some("VERTEX"));
            let Some((vertex, first)) = vertex else { continue };
            let stride = inputs.iter().map(|(_, offset)| offset.saturating_add(1)).max().unwrap_or(1);
            let Some(places) = vertex.attribute("source").and_then(|url| self.places(url)) else {
                return Err("its corners have no positions".to_owned());
            };
            let counts = children(faces, "vcount").next().map(numbers);
            for list in children(faces, "p") {
                let indices = numbers(list);
                let corners: Vec<[f64; 3]> = indices
                    .chunks(stride)
                    .filter_map(|corner| corner.get(*first))
                    .map(|&index| {
                        places.get(index as usize).filter(|_| index >= 0.0).map(|place| transform_place(rows, place))
                    })
                    .collect::<Option<_>>()
                    .ok_or("a face of it names a corner that is not there")?;
                match (&counts, faces.tag_name().name()) {
                    (_, "polygons") => into.fan(&corners)?,
                    (Some(counts), "polylist") => {
                        let mut rest = corners.as_slice();
                        for &count in counts {
                            let Some((face, after)) = rest.split_at_checked(count as usize) else { break };
                            into.fan(face)?;
                            rest = after;
                        }
                    }
                    _ => corners.chunks_exact(3).try_for_each(|face| into.fan(face))?,
                }
            }
        }
        Ok(())
    }
}

/// The transformation of an instance by the nodes above it; `None` if they are too many.
fn place(instance: Node) -> Option<TransformRows> {
    let above: Vec<Node> = instance.ancestors().filter(|node| is(*node, "node")).take(DEEPEST + 1).collect();
    let steps = above.iter().rev().flat_map(|node| node.children().filter(Node::is_element)).filter_map(step);
    (above.len() <= DEEPEST).then(|| steps.fold(STILL, |all, next| product(&all, &next)))
}

/// One step of a node's transformation.
fn step(element: Node) -> Option<TransformRows> {
    let name = element.tag_name().name();
    if !["matrix", "translate", "rotate", "scale"].contains(&name) {
        return None;
    }
    match (name, numbers(element).as_slice()) {
        ("matrix", &[a, b, c, d, e, f, g, h, i, j, k, l, ..]) => Some([[a, b, c, d], [e, f, g, h], [i, j, k, l]]),
        ("translate", &[x, y, z]) => Some([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]]),
        ("scale", &[x, y, z]) => Some([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]]),
        ("rotate", &[x, y, z, degrees]) => {
            let length = (x * x + y * y + z * z).sqrt();
            let [x, y, z] = [x, y, z].map(|it| if length > 0.0 { it / length } else { 0.0 });
            let (s, c) = degrees.to_radians().sin_cos();
            let t = 1.0 - c;
            Some([
                [t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0.0],
                [t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0.0],
                [t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0.0],
            ])
        }
        _ => None,
    }
}

fn product(a: &TransformRows, b: &TransformRows) -> TransformRows {
    let sum = |row: &[f64; 4], column: usize| (0..3).map(|k| row[k] * b[k][column]).sum::<f64>();
    a.map(|row| {
        let [x, y, z, t] = [0, 1, 2, 3].map(|column| sum(&row, column));
        [x, y, z, t + row[3]]
    })
}

fn transform_place(rows: &TransformRows, place: &[f64; 3]) -> [f64; 3] {
    rows.map(|row| row[0] * place[0] + row[1] * place[1] + row[2] * place[2] + row[3])
}

/// A square of 2 mm and a triangle, in millimetres; the square occurs twice in the scene.
#[cfg(test)]
pub(crate) const EXAMPLE: &str = r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
  <library_geometries><geometry id="square"><mesh>
    <source id="places"><float_array id="numbers" count="12">0 0 0 2 0 0 2 2 0 0 2 0</float_array>
      <technique_common><accessor source="#numbers" count="4" stride="3"/></technique_common></source>
    <vertices id="corners"><input semantic="POSITION" source="#places"/></vertices>
    <polylist count="1"><input semantic="VERTEX" source="#corners" offset="0"/><input semantic="NORMAL" source="#none" offset="1"/>
      <vcount>4</vcount><p>0 9 1 9 2 9 3 9</p></polylist>
    <triangles count="1"><input semantic="VERTEX" source="#corners" offset="0"/><p>0 1 3</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene">
    <node><translate>0 0 1000</translate><rotate>0 0 1 90</rotate><node><scale>1 1 2</scale><instance_geometry url="#square"/></node></node>
    <node><matrix>1 0 0 500 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#square"/></node>
  </visual_scene></library_visual_scenes>
</COLLADA>"##;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn geometries_stand_where_their_nodes_put_them_in_metres() {
        let found = triangles(EXAMPLE, Collector::new([1.0; 3], 100)).unwrap();
        assert_eq!(found.len(), 6);
        let near = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        // Turned by 90° about z: x becomes y.
        for (corner, expected) in found[0].iter().zip([[0.0, 0.0, 1.0], [0.0, 0.002, 1.0], [-0.002, 0.002, 1.0]]) {
            assert!(near(*corner, expected), "{corner:?}, expected {expected:?}");
        }
        assert!(near(found[5][1], [0.502, 0.0, 0.0]), "{:?}", found[5]);
        let alone = EXAMPLE.replace("instance_geometry", "extra");
        assert_eq!(triangles(&alone, Collector::new([1.0; 3], 100)).unwrap().len(), 3);
    }

    #[test]
    fn broken_files_are_told_of_in_a_sentence() {
        let cases = [
            ("<COLLADA/>".to_owned(), "no triangles"),
            ("<robot/>".to_owned(), "<robot>"),
            (EXAMPLE.replace("0 1 3<", "0 1 7<"), "not there"),
            (EXAMPLE.replace("#places", "#elsewhere"), "positions"),
            (EXAMPLE[..300].to_owned(), "XML"),
        ];
        for (text, said) in cases {
            let reason = triangles(&text, Collector::new([1.0; 3], 100)).unwrap_err();
            assert!(reason.contains(said) && !reason.contains('\n'), "{reason}");
        }
    }
}
