//! Values of elements in MuJoCo's models: their own, the defaults of their class, and the settings of the compiler.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use nalgebra::{Matrix3, Unit, Vector3};
use roxmltree::Node;

use super::{describe_element, unit};
use poecal_arm::lie::{Pose, rotation};
use poecal_numerics::error::Result;
use poecal_storage::xml::XmlSource;

/// Attributes that state a rotation.
const ROTATIONS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// Settings for the interpretation of numbers.
pub(crate) struct CompilerSettings<'a> {
    in_degrees: bool,
    pub(crate) limits_alone: bool,
    euler: &'a str,
}

impl<'a> CompilerSettings<'a> {
    pub(crate) fn read(source: &XmlSource<'a>, root: Node<'a, 'a>) -> Result<Self> {
        let mut settings = CompilerSettings { in_degrees: true, limits_alone: true, euler: "xyz" };
        for node in source.children(root, "compiler") {
            let is = |name: &str, words: [&str; 2], expected: &str| -> Result<Option<bool>> {
                let word = node.attribute(name);
                let [no, yes] = words.map(|it| (it, it == words[1]));
                let meaning = |word| source.meaning(node, (name, word), "in <compiler>", &[no, yes], expected);
                word.map(meaning).transpose()
            };
            let in_degrees = is("angle", ["radian", "degree"], "degree or radian")?;
            settings.in_degrees = in_degrees.unwrap_or(settings.in_degrees);
            let limits_alone = is("autolimits", ["false", "true"], "true or false")?;
            settings.limits_alone = limits_alone.unwrap_or(settings.limits_alone);
            if let Some(order) = node.attribute("eulerseq") {
                let is_order = order.len() == 3 && order.chars().all(|c| "xyzXYZ".contains(c));
                if !is_order {
                    let message =
                        format!("found eulerseq=\"{order}\" in <compiler>, expected three of x, y, z, X, Y, Z");
                    return source.refuse(node, message);
                }
                settings.euler = order;
            }
            if node.attribute("coordinate") == Some("global") {
                let message = "found coordinate=\"global\" in <compiler>, expected local, as MuJoCo itself since 2.3.4";
                return source.refuse(node, message);
            }
        }
        Ok(settings)
    }

    pub(crate) fn radians(&self, angle: f64) -> f64 {
        if self.in_degrees { angle / 180.0 * PI } else { angle }
    }

    /// Lower case means intrinsic axes, upper case extrinsic ones.
    fn euler(&self, angles: [f64; 3]) -> Matrix3<f64> {
        let mut turn = Matrix3::identity();
        for (axis, angle) in self.euler.chars().zip(angles) {
            let index = "xyz".find(axis.to_ascii_lowercase()).unwrap_or(2);
            let step = rotation::about(index, self.radians(angle));
            turn = if axis.is_ascii_lowercase() { turn * step } else { step * turn };
        }
        turn
    }
}

/// An element, and the class of its defaults if it names none.
#[derive(Clone, Copy)]
pub(crate) struct ElementClass<'a> {
    pub(crate) node: Node<'a, 'a>,
    pub(crate) class: Option<&'a str>,
}

/// Attributes of elements, with their defaults.
pub(crate) struct MjcfDefaults<'a> {
    pub(crate) source: XmlSource<'a>,
    pub(crate) settings: CompilerSettings<'a>,
    /// Blocks of defaults: the element, and the block from which it inherits.
    classes: Vec<(Node<'a, 'a>, Option<usize>)>,
    /// The block of each class.
    blocks: BTreeMap<String, usize>,
    /// The outermost class.
    main: String,
}

impl<'a> MjcfDefaults<'a> {
    pub(crate) fn read(source: XmlSource<'a>, settings: CompilerSettings<'a>, root: Node<'a, 'a>) -> Result<Self> {
        let (classes, blocks, main) = (Vec::new(), BTreeMap::new(), String::new());
        let mut defaults = MjcfDefaults { source, settings, classes, blocks, main };
        for node in source.children(root, "default") {
            defaults.add(node)?;
        }
        Ok(defaults)
    }

    fn add(&mut self, root: Node<'a, 'a>) -> Result<()> {
        if self.main.is_empty() {
            self.main = root.attribute("class").unwrap_or("main").to_owned();
        }
        let outer = self.blocks.get(&self.main).copied();
        let mut steps = vec![(root, outer)];
        while let Some((node, outer)) = steps.pop() {
            let class = node.attribute("class").unwrap_or(&self.main).to_owned();
            let index = self.classes.len();
            self.classes.push((node, outer));
            // Only the outermost class may be stated in parts.
            if self.blocks.insert(class.clone(), index).is_some() && (node != root || class != self.main) {
                let message = format!("found the class `{class}` a second time, expected each class once");
                return self.source.refuse(node, message);
            }
            steps.extend(self.source.children(node, "default").map(|child| (child, Some(index))));
        }
        Ok(())
    }

    /// The first element with one of these attributes: the element itself, or the nearest default of its class for elements of this name.
    pub(crate) fn stating_one(
        &self,
        ElementClass { node, class }: ElementClass<'a>,
        tag: &str,
        names: &[&str],
    ) -> Result<Option<Node<'a, 'a>>> {
        let states = |it: &Node<'a, 'a>| names.iter().any(|name| it.has_attribute(*name));
        let stated = node.attribute("class").or(class);
        let first = self.blocks.get(stated.unwrap_or(&self.main)).copied();
        if let (None, Some(class)) = (first, stated) {
            let message = format!("found the class `{class}`, expected one that a <default> has");
            return self.source.refuse(node, message);
        }
        if states(&node) {
            return Ok(Some(node));
        }
        let mut at = first;
        while let Some((block, outer)) = at.and_then(|at| self.classes.get(at)) {
            let mut own = block.children().filter(|it| it.has_tag_name(tag));
            if let Some(found) = own.find(states) {
                return Ok(Some(found));
            }
            at = *outer;
        }
        Ok(None)
    }

    /// The element that states an attribute.
    pub(crate) fn find_stating(&self, of: ElementClass<'a>, name: &str) -> Result<Option<Node<'a, 'a>>> {
        self.stating_one(of, of.node.tag_name().name(), &[name])
    }

    pub(crate) fn word(&self, of: ElementClass<'a>, name: &str) -> Result<Option<&'a str>> {
        Ok(self.find_stating(of, name)?.and_then(|it| it.attribute(name)))
    }

    pub(crate) fn numbers<const N: usize>(&self, of: ElementClass<'a>, name: &str) -> Result<Option<[f64; N]>> {
        let Some(stating) = self.find_stating(of, name)? else { return Ok(None) };
        self.source.numbers(stating, name, &describe_element(of.node))
    }

    /// A stated direction, with length 1.
    pub(crate) fn direction(&self, node: Node<'a, 'a>, axis: [f64; 3]) -> Result<Unit<Vector3<f64>>> {
        unit(axis).ok_or_else(|| self.no_length(node, "an axis"))
    }

    fn no_length(&self, node: Node<'a, 'a>, what: &str) -> poecal_numerics::error::Error {
        self.source.error(node, format!("found {what} of no length in {}", describe_element(node)))
    }

    /// The pose of an element: `pos`, and one of five attributes for the rotation.
    pub(crate) fn pose(&self, element: ElementClass<'a>) -> Result<Pose> {
        let node = element.node;
        let position = self.numbers::<3>(element, "pos")?.unwrap_or_default();
        // The element that states the rotation determines it alone, whatever outer defaults state.
        let Some(stating) = self.stating_one(element, node.tag_name().name(), &ROTATIONS)? else {
            return Ok(Pose::from_translation(position.into()));
        };
        let of = describe_element(node);
        let mut words = ROTATIONS.into_iter().filter(|name| stating.has_attribute(*name));
        if let (Some(word), Some(second)) = (words.next(), words.next()) {
            let message = format!("found `{word}` and `{second}` in {of}, expected one of them");
            return self.source.refuse(stating, message);
        }
        let turn = if let Some([w, x, y, z]) = self.source.numbers::<4>(stating, "quat", &of)? {
            if w.abs() + x.abs() + y.abs() + z.abs() == 0.0 {
                return Err(self.no_length(node, "a quaternion"));
            }
            return Ok(Pose::from_position_quaternion(position, [x, y, z, w]));
        } else if let Some([x, y, z, angle]) = self.source.numbers::<4>(stating, "axisangle", &of)? {
            let axis = self.direction(node, [x, y, z])?;
            rotation::exp(&(axis.into_inner() * self.settings.radians(angle)))
        } else if let Some(angles) = self.source.numbers::<3>(stating, "euler", &of)? {
            self.settings.euler(angles)
        } else if let Some([a, b, c, d, e, f]) = self.source.numbers::<6>(stating, "xyaxes", &of)? {
            let (x, y) = (self.direction(node, [a, b, c])?, Vector3::new(d, e, f));
            let y = self.direction(node, (y - *x * x.dot(&y)).into())?;
            Matrix3::from_columns(&[*x, *y, x.cross(&y)])
        } else if let Some(z) = self.source.numbers::<3>(stating, "zaxis", &of)? {
            let z = self.direction(node, z)?;
            // For a direction opposite to z, MuJoCo rotates about x.
            match Unit::try_new(Vector3::z().cross(&z), 1e-7) {
                Some(axis) => rotation::exp(&(axis.into_inner() * Vector3::z().cross(&z).norm().atan2(z.z))),
                None if z.z < 0.0 => rotation::about(0, PI),
                None => Matrix3::identity(),
            }
        } else {
            Matrix3::identity()
        };
        Ok(Pose::new(turn, position.into()))
    }
}
