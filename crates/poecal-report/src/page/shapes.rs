//! The shapes of links, for the picture.

use std::borrow::Cow;

use serde::Serialize;

use poecal_numerics::text::escape_invisible;
use poecal_results::calibration_file::PoseEntry;
use poecal_results::shapes::{Mesh, Shape, ShapeForm};

/// A shape on a body.
#[derive(Serialize)]
pub(crate) struct ShapeData<'a> {
    link: Cow<'a, str>,
    /// The joint that moves its body; `None` for the base.
    on: Option<usize>,
    /// Its pose in the base at zero joint values.
    pose: PoseEntry,
    nominal_pose: PoseEntry,
    #[serde(flatten)]
    form: FormData,
}

/// Form, metres.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum FormData {
    Box([f64; 3]),
    /// Radius and length.
    Cylinder([f64; 2]),
    Sphere(f64),
    Mesh(usize),
}

impl<'a> ShapeData<'a> {
    pub(crate) fn from_shape(shape: &'a Shape) -> Self {
        ShapeData {
            link: escape_invisible(&shape.link),
            on: shape.body.joint(),
            pose: (&shape.pose).into(),
            nominal_pose: (&shape.nominal_pose).into(),
            form: match shape.form {
                ShapeForm::Box(sides) => FormData::Box(sides),
                ShapeForm::Cylinder(sizes) => FormData::Cylinder(sizes),
                ShapeForm::Sphere(radius) => FormData::Sphere(radius),
                ShapeForm::Mesh(index) => FormData::Mesh(index),
            },
        }
    }
}

/// A mesh in the form of `io::shapes`.
#[derive(Serialize)]
pub(crate) struct MeshData<'a> {
    least: [f32; 3],
    step: f32,
    places: &'a str,
    corners: &'a str,
    wide: bool,
}

impl<'a> MeshData<'a> {
    pub(crate) fn from_mesh(mesh: &'a Mesh) -> Self {
        let Mesh { least, step, places, corners, wide, .. } = mesh;
        MeshData { least: *least, step: *step, places, corners, wide: *wide }
    }
}
