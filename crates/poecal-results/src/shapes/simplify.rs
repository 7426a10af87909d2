//! Meshes as texts of a limited length: nearby vertices are merged, in larger cells the more there are.

use std::collections::HashMap;

use super::Mesh;
use super::collector::Triangles;

/// Steps along the longest side of a mesh.
const STEPS: f32 = 65535.0;
/// First and smallest cell in which vertices are merged if there are too many, and the step of its growth, metres.
const FINEST: f32 = 2.5e-4;
const COARSER: f32 = std::f32::consts::SQRT_2;
/// The largest cell, metres: triangles of that size would not show a robot.
const COARSEST: f32 = 0.1;

/// Vertices and triangles between them.
struct IndexedMesh {
    places: Vec<[f32; 3]>,
    corners: Vec<[u32; 3]>,
}

/// All meshes as texts of at most `most` characters together. If even the coarsest are longer, the last ones are empty.
pub(crate) fn fit_to_size(meshes: &[Triangles], most: usize) -> Vec<Mesh> {
    let bounds: Vec<([f32; 3], f32)> = meshes.iter().map(bounds).collect();
    let mut cell = 0.0;
    loop {
        let merged: Vec<IndexedMesh> =
            meshes.iter().zip(&bounds).map(|(mesh, bounds)| merge_corners(mesh, *bounds, cell)).collect();
        let length: usize = merged.iter().map(characters).sum();
        if length <= most || cell > COARSEST {
            let mut left = most;
            let written = |(it, bounds): (&IndexedMesh, &([f32; 3], f32))| {
                let fits = characters(it) <= left;
                left -= if fits { characters(it) } else { 0 };
                if fits { write_mesh(it, *bounds) } else { Mesh::default() }
            };
            return merged.iter().zip(&bounds).map(written).collect();
        }
        cell = if cell > 0.0 { cell * COARSER } else { FINEST };
    }
}

/// The corner with the least coordinates, and the step by which 16 bits reach from it over the longest side.
fn bounds(mesh: &Triangles) -> ([f32; 3], f32) {
    let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for corner in mesh.iter().flatten() {
        for k in 0..3 {
            least[k] = least[k].min(corner[k]);
            most[k] = most[k].max(corner[k]);
        }
    }
    let longest = (0..3).map(|k| most[k] - least[k]).fold(0.0, f32::max);
    (least, (longest / STEPS).max(f32::MIN_POSITIVE))
}

/// Vertices in one cell merged at their mean; triangles that degenerate are left out.
fn merge_corners(mesh: &Triangles, (least, step): ([f32; 3], f32), cell: f32) -> IndexedMesh {
    let side = cell.max(step);
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut sums: Vec<([f64; 3], f64)> = Vec::new();
    let mut corners: Vec<[u32; 3]> = Vec::new();
    for triangle in mesh {
        let indices = triangle.map(|corner| {
            let key = [0, 1, 2].map(|k| ((corner[k] - least[k]) / side).round() as u32);
            let index = *known.entry(key).or_insert_with(|| {
                sums.push(([0.0; 3], 0.0));
                sums.len() as u32 - 1
            });
            let (sum, count) = &mut sums[index as usize];
            (0..3).for_each(|k| sum[k] += f64::from(corner[k]));
            *count += 1.0;
            index
        });
        let [a, b, c] = indices;
        if a != b && b != c && c != a {
            corners.push(indices);
        }
    }
    drop_unused(&sums, corners)
}

/// The mesh without unused vertices and repeated triangles.
fn drop_unused(sums: &[([f64; 3], f64)], mut corners: Vec<[u32; 3]>) -> IndexedMesh {
    let mut seen = std::collections::HashSet::new();
    corners.retain(|triangle| {
        let mut sorted = *triangle;
        sorted.sort_unstable();
        seen.insert(sorted)
    });
    let mut new = vec![u32::MAX; sums.len()];
    let mut places = Vec::new();
    for index in corners.iter_mut().flatten() {
        let own = &mut new[*index as usize];
        if *own == u32::MAX {
            *own = places.len() as u32;
            let (sum, count) = sums[*index as usize];
            places.push(sum.map(|value| (value / count) as f32));
        }
        *index = *own;
    }
    IndexedMesh { places, corners }
}

fn is_wide(mesh: &IndexedMesh) -> bool {
    mesh.places.len() > usize::from(u16::MAX) + 1
}

fn characters(mesh: &IndexedMesh) -> usize {
    let of = |bytes: usize| bytes.div_ceil(3) * 4;
    of(6 * mesh.places.len()) + of(mesh.corners.len() * if is_wide(mesh) { 12 } else { 6 })
}

fn write_mesh(mesh: &IndexedMesh, (least, step): ([f32; 3], f32)) -> Mesh {
    let wide = is_wide(mesh);
    let steps = mesh
        .places
        .iter()
        .flat_map(|place| [0, 1, 2].map(|k| ((place[k] - least[k]) / step).round().clamp(0.0, STEPS) as u16));
    let places: Vec<u8> = steps.flat_map(u16::to_le_bytes).collect();
    let indices = mesh.corners.iter().flatten();
    let corners: Vec<u8> = if wide {
        indices.flat_map(|index| index.to_le_bytes()).collect()
    } else {
        indices.flat_map(|&index| (index as u16).to_le_bytes()).collect()
    };
    Mesh { least, step, places: base64(&places), corners: base64(&corners), wide, triangles: mesh.corners.len() }
}

/// Bytes as text (RFC 4648).
#[must_use]
pub fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let at = |k: usize| u32::from(three.get(k).copied().unwrap_or_default());
        let bits = (at(0) << 16) | (at(1) << 8) | at(2);
        for k in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * k)) as usize & 63];
            text.push(if k <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere of some rings.
    fn sphere(radius: f32, rings: usize) -> Triangles {
        let place = |i: usize, k: usize| {
            let (a, b) =
                (std::f32::consts::PI * i as f32 / rings as f32, std::f32::consts::TAU * k as f32 / rings as f32);
            // Exactly one vertex at each pole.
            let ring = if i.is_multiple_of(rings) { 0.0 } else { radius * a.sin() };
            [ring * b.cos(), ring * b.sin(), radius * a.cos()]
        };
        let cells = (0..rings).flat_map(|i| (0..rings).map(move |k| (i, k)));
        cells
            .flat_map(|(i, k)| {
                let [a, b, c, d] = [place(i, k), place(i + 1, k), place(i + 1, k + 1), place(i, k + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    #[test]
    fn text_of_bytes_is_that_of_the_standard() {
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn corners_become_one_and_finer_meshes_coarser_within_the_limit() {
        let mesh = sphere(0.2, 40);
        let whole = fit_to_size(std::slice::from_ref(&mesh), 1_000_000).remove(0);
        // The triangles at the poles have no area.
        assert_eq!(whole.triangles, mesh.len() - 2 * 40);
        assert_eq!(whole.places.len(), (6_usize * (39 * 40 + 2)).div_ceil(3) * 4);
        let fine = [sphere(0.2, 300), sphere(0.1, 200)];
        let most = 60_000;
        let coarse = fit_to_size(&fine, most);
        let length: usize = coarse.iter().map(|it| it.places.len() + it.corners.len()).sum();
        println!(
            "{} and {} triangles of {} and {}: {length} characters",
            coarse[0].triangles,
            coarse[1].triangles,
            fine[0].len(),
            fine[1].len()
        );
        assert!(length <= most && length > most / 4 && coarse.iter().all(|it| it.triangles > 500));
        assert_eq!(coarse, fit_to_size(&fine, most));
        // Wide indices for more than 16 bits.
        assert!(fit_to_size(&fine[..1], 10_000_000)[0].wide);
        // Nothing fits.
        assert_eq!(fit_to_size(&fine, 10), [Mesh::default(), Mesh::default()]);
    }
}
