//! Appearance of a robot: the shapes of its links, from the URDF in a `calibration.json` and the meshes that it names.

mod capsules;
mod collada;
mod collector;
mod find;
mod mesh;
mod mesh_text;
mod obj;
mod simplify;
mod stl;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use self::collector::{MOST_TRIANGLES, Triangles};
use self::find::Folders;

pub use self::capsules::capsules_of;
pub use self::mesh_text::Mesh;
pub use self::simplify::base64;
use self::simplify::fit_to_size;
use super::calibration_file::CalibrationFile;
use poecal_arm::lie::Pose;
use poecal_formats::urdf::{Geometry, Visual};
use poecal_model::robot::{Body, Robot};

/// Most characters of all meshes in a page: about 80,000 triangles. Finer meshes are made coarser.
pub const MOST_CHARACTERS: usize = 1_000_000;
/// Most names of meshes in a note.
const NAMED: usize = 3;
/// Ratio of a mesh's size to the arm's above which the arm would not be visible beside the mesh.
const MOST_ARMS: f64 = 20.0;

/// The form of a shape, metres. Boxes, cylinders (along z) and spheres are about their centres; a mesh has the axes of its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeForm {
    /// Its sides.
    Box([f64; 3]),
    /// Radius and length.
    Cylinder([f64; 2]),
    /// Its radius.
    Sphere(f64),
    /// Index into [`Shapes::meshes`].
    Mesh(usize),
}

/// A shape of a link with its pose at zero joint values.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The link.
    pub link: String,
    /// The body that carries it.
    pub body: Body,
    /// Its pose in the base, calibrated: it remains fixed to the frame of its joint.
    pub pose: Pose,
    /// Its pose in the base by the nominal model.
    pub nominal_pose: Pose,
    /// Its form.
    pub form: ShapeForm,
}

/// Shapes of a robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes {
    /// The shapes, in the order of the URDF.
    pub shapes: Vec<Shape>,
    /// Meshes of these shapes.
    pub meshes: Vec<Mesh>,
    /// Meshes that are not drawn with their reasons, in sentences.
    pub notes: Vec<String>,
}

impl Shapes {
    /// Boxes, cylinders and spheres of the URDF that was calibrated, without opening any file. Empty if the model was no URDF.
    #[must_use]
    pub fn from_calibration(file: &CalibrationFile) -> Self {
        collect_shapes(file, &mut |_, _| None)
    }

    /// Shapes with the meshes that the URDF names: STL, OBJ or COLLADA, beside the URDF, or beside the `calibration.json` at `path`. A mesh that is
    /// missing or broken adds a note. If all would be larger than [`MOST_CHARACTERS`], they are made coarser.
    #[must_use]
    pub fn read(file: &CalibrationFile, path: &Path) -> Self {
        let folders = Folders::from_files(&[Path::new(&file.inputs.model), path]);
        let (mut read, mut missing, mut notes) = (Vec::<Triangles>::new(), Vec::new(), Vec::new());
        let mut known: BTreeMap<(String, [u64; 3]), Option<usize>> = BTreeMap::new();
        let mut triangles = 0;
        let arm_m = file.robot().map_or(f64::INFINITY, |robot| robot.reach_m());
        let mut shapes = collect_shapes(file, &mut |name, scale| {
            *known.entry((name.to_owned(), scale.map(f64::to_bits))).or_insert_with(|| {
                let Some(found) = folders.find(name) else {
                    missing.push(name.to_owned());
                    return None;
                };
                match mesh::read(&found, scale, MOST_TRIANGLES.saturating_sub(triangles)) {
                    Ok(mesh) if mesh::longest_m(&mesh) > MOST_ARMS * arm_m => {
                        let (size, arm) = (mesh::longest_m(&mesh), arm_m);
                        notes.push(format!(
                            "The mesh `{name}` is not drawn: it is {size:.0} m long, the arm {arm:.2} m. If it is in millimetres, write \
                             scale=\"0.001 0.001 0.001\" beside its name in the URDF."
                        ));
                        None
                    }
                    Ok(mesh) => {
                        triangles += mesh.len();
                        read.push(mesh);
                        Some(read.len() - 1)
                    }
                    Err(reason) => {
                        notes.push(format!("The mesh `{name}` is not drawn: {reason}."));
                        None
                    }
                }
            })
        });
        shapes.meshes = fit_to_size(&read, MOST_CHARACTERS);
        if let Some(first) = missing.first() {
            let count = missing.len();
            let named: Vec<String> = missing.iter().take(NAMED).map(|name| format!("`{name}`")).collect();
            shapes.notes.push(match count {
                1 => format!("The mesh `{first}` was not found beside the URDF, and is not drawn."),
                _ => format!(
                    "{count} meshes were not found beside the URDF, and are not drawn: {}{}.",
                    named.join(", "),
                    if count > NAMED { " and others" } else { "" }
                ),
            });
        }
        shapes.notes.append(&mut notes);
        shapes
    }
}

/// The shapes of a file; `mesh` returns the index of a mesh by its name and scale.
fn collect_shapes(file: &CalibrationFile, mesh: &mut dyn FnMut(&str, [f64; 3]) -> Option<usize>) -> Shapes {
    let path = PathBuf::from(&file.inputs.model);
    let (Ok(Some(urdf)), Ok(robot), Ok(nominal)) = (file.original_urdf(&path), file.robot(), file.nominal_robot())
    else {
        return Shapes::default();
    };
    let names = |robot: &Robot| robot.joints.iter().map(|joint| joint.name.clone()).collect::<Vec<_>>();
    if names(urdf.robot()) != names(&robot) {
        return Shapes::default();
    }
    // Frames of the URDF, moved with the axes of the nominal model if this has been calibrated before.
    let screws: Vec<_> = nominal.joints.iter().map(|joint| joint.screw).collect();
    let nominal = urdf.robot().with_screws(&screws);
    let on = |robot: &Robot, body: Body, pose: Pose| match body {
        Body::Base => pose,
        Body::Link(k) => robot.joints[k].frame * urdf.robot().joints[k].frame.inverse() * pose,
    };
    let shape = |Visual { link, body, base_from_shape, geometry }| {
        let form = match geometry {
            Geometry::Box(sides) => ShapeForm::Box(sides),
            Geometry::Cylinder { radius, length } => ShapeForm::Cylinder([radius, length]),
            Geometry::Sphere { radius } => ShapeForm::Sphere(radius),
            Geometry::Mesh { file, scale } => ShapeForm::Mesh(mesh(&file, scale)?),
        };
        let (pose, nominal_pose) = (on(&robot, body, base_from_shape), on(&nominal, body, base_from_shape));
        Some(Shape { link, body, pose, nominal_pose, form })
    };
    Shapes { shapes: urdf.visuals().into_iter().filter_map(shape).collect(), ..Shapes::default() }
}
