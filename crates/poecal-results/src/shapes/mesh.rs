//! Meshes as triangles, from files of any form.

use std::io::Read as _;
use std::path::Path;

use super::collector::{Collector, MeshReason, Triangles};
use super::{collada, obj, stl};
use poecal_storage::disk;

/// Largest file, bytes.
const LARGEST: u64 = 64 << 20;
/// Reads a file.
pub(crate) fn read(path: &Path, scale: [f64; 3], most: usize) -> Result<Triangles, MeshReason> {
    let mut bytes = Vec::new();
    let unreadable = |error: std::io::Error| format!("the file cannot be read ({error})");
    disk::current_disk()
        .open(path)
        .map_err(unreadable)?
        .take(LARGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST {
        return Err(format!("the file is larger than {} MiB", LARGEST >> 20));
    }
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    parsed(&bytes, ending.as_deref().unwrap_or_default(), Collector::new(scale, most))
}

/// The triangles of a file's bytes by the ending of its name.
pub(crate) fn parsed(bytes: &[u8], ending: &str, into: Collector) -> Result<Triangles, MeshReason> {
    match ending {
        "stl" => stl::triangles(bytes, into),
        "obj" => obj::triangles(&text(bytes)?, into),
        "dae" => collada::triangles(&text(bytes)?, into),
        _ => Err("its form is none of STL, OBJ and COLLADA (.stl, .obj, .dae)".to_owned()),
    }
}

/// The longest side of the box about triangles, metres.
pub(crate) fn longest_m(mesh: &Triangles) -> f64 {
    let side = |k: usize| {
        let places = mesh.iter().flatten().map(|corner| corner[k]);
        let (least, most) = places.fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        f64::from(most) - f64::from(least)
    };
    (0..3).map(side).fold(0.0, f64::max)
}

fn text(bytes: &[u8]) -> Result<std::borrow::Cow<'_, str>, MeshReason> {
    if bytes.contains(&0) {
        return Err("the file is no text".to_owned());
    }
    // Names and comments may be in any encoding; numbers are not.
    Ok(String::from_utf8_lossy(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudorandom bytes (xorshift64).
    fn noise(seed: u64, count: usize) -> Vec<u8> {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 32) as u8
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn no_bytes_make_a_reader_fail_otherwise_than_by_a_sentence() {
        let seeds: [(&str, &[u8]); 4] = [
            ("stl", b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid"),
            ("obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1/1 2/2 3/3 -1\n"),
            ("dae", collada::EXAMPLE.as_bytes()),
            ("stl", &stl::tests::binary(&[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; 3])),
        ];
        let (mut understood, mut refused) = (0, 0);
        for (ending, whole) in seeds {
            for seed in 0..3000_u64 {
                let mut bytes = whole.to_vec();
                let changes = noise(seed + 1, 12);
                for pair in changes.chunks(2).take(1 + seed as usize % 6) {
                    let at = (usize::from(pair[0]) * 7 + seed as usize) % bytes.len();
                    bytes[at] = pair[1];
                }
                if seed % 5 == 0 {
                    bytes.truncate(usize::from(changes[11]) * whole.len() / 256);
                }
                match parsed(&bytes, ending, Collector::new([1.0; 3], 1000)) {
                    Ok(found) => {
                        understood += 1;
                        assert!(!found.is_empty() && found.len() <= 1000);
                        assert!(found.iter().flatten().flatten().all(|value| value.is_finite()));
                    }
                    Err(reason) => {
                        refused += 1;
                        assert!(!reason.is_empty() && !reason.contains('\n'), "{reason:?}");
                    }
                }
            }
        }
        println!("{understood} of changed meshes understood, {refused} refused");
        assert!(understood > 1000 && refused > 1000);
        for ending in ["stl", "obj", "dae"] {
            for seed in 0..200 {
                let _ = parsed(&noise(seed, 500), ending, Collector::new([1.0; 3], 1000));
            }
        }
    }

    #[test]
    fn more_triangles_than_allowed_are_refused() {
        let bytes = stl::tests::binary(&[[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; 11]);
        assert_eq!(parsed(&bytes, "stl", Collector::new([1.0; 3], 11)).unwrap().len(), 11);
        let reason = parsed(&bytes, "stl", Collector::new([1.0; 3], 10)).unwrap_err();
        assert!(reason.contains("triangles"), "{reason}");
    }
}
