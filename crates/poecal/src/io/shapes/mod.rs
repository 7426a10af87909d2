//! What a robot looks like: the shapes of its links, from the URDF in a `calibration.json` and the meshes that it names.

mod collada;
mod collector;
mod find;
mod mesh;
mod obj;
mod simplify;
mod stl;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use self::collector::{MOST_TRIANGLES, Triangles};
use self::find::Folders;

use self::simplify::fitted;
use super::calibration_file::CalibrationFile;
use super::urdf::{Geometry, Visual};
use crate::lie::Pose;
use crate::robot::{Body, Robot};

/// Characters of all meshes in a page, at most: about 80,000 triangles. Finer ones are made coarser.
pub const MOST_CHARACTERS: usize = 1_000_000;
/// Names of meshes in a note.
const NAMED: usize = 3;
/// A mesh that is larger than this many arms would leave nothing of the arm to see.
const MOST_ARMS: f64 = 20.0;

/// The form of a shape, metres. Boxes, cylinders (along z) and spheres are about their middles; a mesh has the axes of its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Its sides.
    Box([f64; 3]),
    /// Radius and length.
    Cylinder([f64; 2]),
    /// Its radius.
    Sphere(f64),
    /// Index into [`Shapes::meshes`].
    Mesh(usize),
}

/// A shape of a link, and where it is with all joints at zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The link.
    pub link: String,
    /// The body that carries it.
    pub body: Body,
    /// Its pose in the base, calibrated: it stays with the frame of its joint.
    pub pose: Pose,
    /// Its pose in the base by the nominal model.
    pub nominal_pose: Pose,
    /// Its form.
    pub form: Form,
}

/// A mesh as text: places in whole steps from a corner, and three of them for each triangle. Both are little-endian numbers in base 64.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The corner, metres.
    pub least: [f32; 3],
    /// The step, metres.
    pub step: f32,
    /// x, y and z of each place, 16 bits each.
    pub places: String,
    /// Indices of places, 16 bits each, or 32 if `wide`.
    pub corners: String,
    /// Whether indices have 32 bits.
    pub wide: bool,
    /// Number of triangles.
    pub triangles: usize,
}

/// What a robot looks like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shapes {
    /// The shapes, in the order of the URDF.
    pub shapes: Vec<Shape>,
    /// Meshes of these shapes.
    pub meshes: Vec<Mesh>,
    /// Meshes that are not drawn, and why, in sentences.
    pub notes: Vec<String>,
}

impl Shapes {
    /// Boxes, cylinders and spheres of the URDF that was calibrated, without opening any file. Nothing if the model was no URDF.
    #[must_use]
    pub fn of(file: &CalibrationFile) -> Self {
        collected(file, &mut |_, _| None)
    }

    /// The same with the meshes that the URDF names: STL, OBJ or COLLADA, beside the URDF, or beside the `calibration.json` at `path`. A
    /// mesh that is missing or broken gives a note; if all would be larger than [`MOST_CHARACTERS`], they are made coarser.
    #[must_use]
    pub fn read(file: &CalibrationFile, path: &Path) -> Self {
        let folders = Folders::of(&[Path::new(&file.inputs.model), path]);
        let (mut read, mut missing, mut notes) = (Vec::<Triangles>::new(), Vec::new(), Vec::new());
        let mut known: BTreeMap<(String, [u64; 3]), Option<usize>> = BTreeMap::new();
        let mut triangles = 0;
        let arm_m = file.robot().map_or(f64::INFINITY, |robot| robot.reach_m());
        let mut shapes = collected(file, &mut |name, scale| {
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
        shapes.meshes = fitted(&read, MOST_CHARACTERS);
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

/// The shapes of a file; `mesh` gives the index of a mesh by its name and scale.
fn collected(file: &CalibrationFile, mesh: &mut dyn FnMut(&str, [f64; 3]) -> Option<usize>) -> Shapes {
    let path = PathBuf::from(&file.inputs.model);
    let (Ok(Some(urdf)), Ok(robot), Ok(nominal)) =
        (file.original_urdf(&path), file.robot(), file.nominal_robot())
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
            Geometry::Box(sides) => Form::Box(sides),
            Geometry::Cylinder { radius, length } => Form::Cylinder([radius, length]),
            Geometry::Sphere { radius } => Form::Sphere(radius),
            Geometry::Mesh { file, scale } => Form::Mesh(mesh(&file, scale)?),
        };
        let (pose, nominal_pose) = (on(&robot, body, base_from_shape), on(&nominal, body, base_from_shape));
        Some(Shape { link, body, pose, nominal_pose, form })
    };
    Shapes { shapes: urdf.visuals().into_iter().filter_map(shape).collect(), ..Shapes::default() }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::calibration::{CalibrationOptions, calibrate};
    use crate::io::calibration_file::Inputs;
    use crate::io::model::Model;
    use crate::simulate::{Kind, Simulation};

    const TEXT: &str = r#"<robot name="two">
      <link name="base"><visual><geometry><mesh filename="meshes/base.obj"/></geometry></visual></link>
      <link name="upper"><visual><origin xyz="0.2 0 0"/><geometry><mesh filename="package://cell/robot/meshes/arm.STL" scale="0.001 0.001 0.001"/></geometry></visual>
        <visual><geometry><mesh filename="package://elsewhere/arm.stl"/></geometry></visual></link>
      <link name="lower"><visual><geometry><mesh filename="meshes/broken.stl"/></geometry></visual>
        <visual><geometry><mesh filename="meshes/large.stl"/></geometry></visual>
        <visual><geometry><mesh filename="meshes/base.obj"/></geometry></visual></link>
      <joint name="a" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
      <joint name="b" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0.1"/><axis xyz="0 1 0"/></joint>
    </robot>"#;

    #[test]
    fn meshes_are_found_beside_the_urdf_and_others_are_named() {
        let cell = std::env::temp_dir().join(format!("poecal_shapes_{}", std::process::id())).join("cell");
        let meshes = cell.join("robot/meshes");
        fs::create_dir_all(&meshes).unwrap();
        let triangle = [[0.0; 3], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0]];
        fs::write(meshes.join("arm.STL"), stl::tests::binary(&[triangle])).unwrap();
        fs::write(meshes.join("base.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        fs::write(meshes.join("broken.stl"), "solid nothing").unwrap();
        fs::write(meshes.join("large.stl"), stl::tests::binary(&[triangle])).unwrap();
        fs::create_dir(meshes.join("folder.stl")).unwrap();
        let path = cell.join("robot/two.urdf");
        fs::write(&path, TEXT).unwrap();
        let model = Model::read(&path, &Default::default()).unwrap();
        let made = Simulation::default().run(&model.robot, Kind::Pose).unwrap();
        let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
        let file = CalibrationFile::new(&calibration, &made.data, Inputs::of_model(&model));

        let found = Shapes::read(&file, &cell.join("out/calibration.json"));
        let of: Vec<(&str, Option<usize>, Form)> =
            found.shapes.iter().map(|it| (it.link.as_str(), it.body.joint(), it.form)).collect();
        // The same mesh twice is there once.
        let expected = [
            ("base", None, Form::Mesh(0)),
            ("upper", Some(0), Form::Mesh(1)),
            ("lower", Some(1), Form::Mesh(0)),
        ];
        assert_eq!(of, expected);
        assert_eq!(found.notes.len(), 3, "{:?}", found.notes);
        assert!(found.notes[0].contains("`package://elsewhere/arm.stl` was not found"), "{:?}", found.notes);
        assert!(
            found.notes[1].contains("`meshes/broken.stl` is not drawn: found no triangles"),
            "{:?}",
            found.notes
        );
        assert!(
            found.notes[2].contains("`meshes/large.stl` is not drawn: it is 100 m long, the arm 0.4"),
            "{:?}",
            found.notes
        );
        assert_eq!(found.meshes.iter().map(|it| it.triangles).collect::<Vec<_>>(), [1, 1]);
        let longest = found.meshes[1].step * 65535.0;
        assert!((longest - 0.1).abs() < 1e-6, "{longest} m, of 100 by 0.001");
        assert_eq!(found, Shapes::read(&file, &cell.join("out/calibration.json")));
        // Of links that move, shapes stay with the frames of their joints.
        let shape = &found.shapes[2];
        let (nominal, calibrated) =
            (&calibration.nominal.joints[1].frame, &calibration.robot.joints[1].frame);
        let apart = (nominal.inverse() * shape.nominal_pose).apart(&(calibrated.inverse() * shape.pose));
        let moved = shape.nominal_pose.apart(&shape.pose);
        println!("shapes stand on their joints within {apart:?}, which the calibration moved by {moved:?}");
        // Rounding of frames about 1 m.
        assert!(apart.0 < 1e-12 && apart.1 < 1e-7 && moved.0 > 1e-6, "{apart:?}, {moved:?}");
        assert_eq!((Shapes::of(&file).shapes.len(), Shapes::of(&file).notes.len()), (0, 0));

        // Beside the calibration, where the URDF is no more.
        fs::rename(cell.join("robot"), cell.join("out")).unwrap();
        let again = Shapes::read(&file, &cell.join("out/calibration.json"));
        assert_eq!(again.shapes.len(), 2, "the package's folder has another name now: {:?}", again.notes);
        fs::remove_dir_all(cell.parent().unwrap()).unwrap();
        let none = Shapes::read(&file, Path::new("calibration.json"));
        assert_eq!((none.shapes.len(), none.notes.len()), (0, 1));
        assert!(none.notes[0].starts_with("5 meshes were not found"), "{:?}", none.notes);
    }

    #[test]
    fn a_box_is_drawn_without_any_file() {
        let box_instead = r#"<box size="0.4 0.05 0.05"/>"#;
        let text = TEXT.replace(r#"<mesh filename="package://elsewhere/arm.stl"/>"#, box_instead);
        let model = Model::parse(&text, "two.urdf", &Default::default()).unwrap();
        let made = Simulation::default().run(&model.robot, Kind::Pose).unwrap();
        let calibration = calibrate(&made.nominal, &made.data, &CalibrationOptions::default()).unwrap();
        let mut file = CalibrationFile::new(&calibration, &made.data, Inputs::of_model(&model));
        let found = Shapes::of(&file).shapes;
        assert_eq!(
            (found.len(), found[0].link.as_str(), found[0].form),
            (1, "upper", Form::Box([0.4, 0.05, 0.05]))
        );

        // Of a robot that is no URDF nothing is known.
        file.inputs.urdf = None;
        assert_eq!(Shapes::read(&file, Path::new("calibration.json")), Shapes::default());
    }
}
