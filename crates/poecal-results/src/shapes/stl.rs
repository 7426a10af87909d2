//! STL, binary and as text.

use super::collector::{Collector, MeshReason, Triangles};

/// Bytes before the number of triangles, and of a triangle: its normal, three vertices, and two bytes without a meaning.
const HEAD: usize = 80;
const TRIANGLE: usize = 50;
const NORMAL: usize = 12;

pub(crate) fn triangles(bytes: &[u8], into: Collector) -> Result<Triangles, MeshReason> {
    // Some binary files begin with `solid` too: their length decides.
    let count = bytes.get(HEAD..HEAD + 4).and_then(|four| four.try_into().ok()).map(u32::from_le_bytes);
    let binary = bytes.get(HEAD + 4..).unwrap_or_default();
    match count {
        Some(count) if binary.len() as u64 == u64::from(count) * TRIANGLE as u64 => of_binary(binary, into),
        _ if bytes.trim_ascii_start().starts_with(b"solid") => of_text(bytes, into),
        Some(count) => Err(format!(
            "found {} bytes of triangles in it, expected {TRIANGLE} for each of the {count} that it states",
            binary.len()
        )),
        None => Err("found neither a binary STL in it nor one as text".to_owned()),
    }
}

fn of_binary(bytes: &[u8], mut into: Collector) -> Result<Triangles, MeshReason> {
    for triangle in bytes.chunks_exact(TRIANGLE) {
        let mut numbers = triangle[NORMAL..].chunks_exact(4).map(|four| {
            let four = <[u8; 4]>::try_from(four).unwrap_or_default();
            f64::from(f32::from_le_bytes(four))
        });
        let corners = [(); 3].map(|()| [(); 3].map(|()| numbers.next().unwrap_or(f64::NAN)));
        into.add(corners)?;
    }
    into.into_triangles()
}

fn of_text(bytes: &[u8], mut into: Collector) -> Result<Triangles, MeshReason> {
    let text = String::from_utf8_lossy(bytes);
    let mut corners = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("vertex") => {
                let mut number = || words.next()?.parse::<f64>().ok();
                let (Some(x), Some(y), Some(z)) = (number(), number(), number()) else {
                    return Err(format!("found no three numbers after `vertex` in its line {}", k + 1));
                };
                corners.push([x, y, z]);
            }
            Some("endfacet") => {
                into.fan(&corners)?;
                corners.clear();
            }
            Some(_) | None => {}
        }
    }
    into.into_triangles()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A binary STL.
    pub(crate) fn binary(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = b"solid, though binary".to_vec();
        bytes.resize(HEAD, b' ');
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; NORMAL]);
            bytes.extend(triangle.iter().flatten().flat_map(|value| value.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    #[test]
    fn both_forms_give_the_same_triangles() {
        let made = [[[0.0, 0.5, 0.0], [1.0, 0.0, 0.25], [0.0, 1.0, -2.0]]; 2];
        let text = "solid a b\n facet normal 0 0 0\n  outer loop\n   vertex 0 .5 0\n   vertex 1 0 2.5e-1\n   vertex 0 1 -2\n  endloop\n endfacet\n";
        let scale = [1.0, 2.0, 1.0];
        let read = |bytes: &[u8]| triangles(bytes, Collector::new(scale, 100));
        let expected = made[0].map(|[x, y, z]| [x, 2.0 * y, z]);
        assert_eq!(read(&binary(&made)).unwrap(), [expected; 2]);
        assert_eq!(read(text.repeat(2).as_bytes()).unwrap(), [expected; 2]);
        let cut = &binary(&made)[..150];
        assert_eq!(read(cut).unwrap_err(), "found no triangles in it");
        assert!(read(b"nothing").is_err());
        assert!(read(b"solid\nvertex 1 2\n").unwrap_err().contains("line 2"));
    }
}
