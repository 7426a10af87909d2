//! Capsules that contain the shapes of a URDF's links.

use std::path::Path;

use nalgebra::Vector3;

use super::collector::MOST_TRIANGLES;
use super::find::Folders;
use super::mesh;
use crate::model::{Model, ModelSource};
use poecal_arm::lie::Pose;
use poecal_formats::urdf::{Geometry, UrdfDocument, Visual};
use poecal_model::robot::Body;
use poecal_plan::plan::Capsule;

/// Vertices of the polygon around a circle.
const CORNERS: usize = 16;

/// Capsules of a model that has shapes, and sentences as of `capsules`; empty for other models.
#[must_use]
pub fn capsules_of(model: &Model) -> (Vec<Capsule>, Vec<String>) {
    match &model.source {
        ModelSource::Urdf(urdf) => capsules(urdf, &model.path),
        ModelSource::Toml | ModelSource::Calibration(_) => Default::default(),
    }
}

/// A capsule around each shape of the links, `<collision>` if the model has any, else `<visual>`. The sentences are about meshes beside the URDF that
/// do not exist or cannot be read.
#[must_use]
fn capsules(urdf: &UrdfDocument, path: &Path) -> (Vec<Capsule>, Vec<String>) {
    let folders = Folders::from_files(&[path]);
    let (mut found, mut notes, mut triangles) = (Vec::new(), Vec::new(), 0);
    for Visual { link, body, base_from_shape, geometry } in urdf.collisions() {
        let (points, grown) = match geometry {
            Geometry::Box(sides) => {
                let half = sides.map(|side| 0.5 * side);
                let corner = |k: usize, bit: usize| if k >> bit & 1 == 0 { -half[bit] } else { half[bit] };
                ((0..8).map(|k| Vector3::new(corner(k, 0), corner(k, 1), corner(k, 2))).collect(), 0.0)
            }
            Geometry::Cylinder { radius, length } => {
                // A polygon around the circle.
                let outer = radius / (std::f64::consts::PI / CORNERS as f64).cos();
                let at = |k: usize, z: f64| {
                    let (s, c) = (std::f64::consts::TAU * k as f64 / CORNERS as f64).sin_cos();
                    Vector3::new(outer * c, outer * s, z)
                };
                let ends = [-0.5 * length, 0.5 * length];
                (ends.into_iter().flat_map(|z| (0..CORNERS).map(move |k| at(k, z))).collect(), 0.0)
            }
            Geometry::Sphere { radius } => (vec![Vector3::zeros()], radius),
            Geometry::Mesh { file, scale } => {
                let read = match folders.find(&file) {
                    None => Err("the file was not found beside the URDF".to_owned()),
                    Some(found) => mesh::read(&found, scale, MOST_TRIANGLES.saturating_sub(triangles)),
                };
                match read {
                    Ok(read) => {
                        triangles += read.len();
                        let corners = read.iter().flatten().map(|corner| Vector3::from(corner.map(f64::from)));
                        (corners.collect::<Vec<_>>(), 0.0)
                    }
                    Err(reason) => {
                        notes.push(format!("the mesh `{file}` of {link} is left out of what may collide: {reason}"));
                        continue;
                    }
                }
            }
        };
        let joint = body.joint().and_then(|joint| urdf.robot().joints.get(joint));
        let own: Pose = joint.map_or(base_from_shape, |joint| joint.frame.inverse() * base_from_shape);
        let points: Vec<Vector3<f64>> = points.iter().map(|it| own.rotation * it + own.translation).collect();
        found.extend(Capsule::enclosing(&link, body, &points, grown));
    }
    if found.iter().all(|it| it.body == Body::Base) {
        found.clear();
    }
    (found, notes)
}
