//! Wavefront OBJ: vertices (`v`) and faces (`f`), nothing else.

use super::collector::{Collector, MeshReason, Triangles};

pub(crate) fn triangles(text: &str, mut into: Collector) -> Result<Triangles, MeshReason> {
    let (mut places, mut face): (Vec<[f64; 3]>, Vec<[f64; 3]>) = (Vec::new(), Vec::new());
    for (k, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let mut number = || words.next()?.parse::<f64>().ok();
                let (Some(x), Some(y), Some(z)) = (number(), number(), number()) else {
                    return Err(format!("found no three numbers after `v` in its line {}", k + 1));
                };
                places.push([x, y, z]);
            }
            Some("f") => {
                face.clear();
                for word in words {
                    let Some(&place) = index(word, places.len()).and_then(|at| places.get(at)) else {
                        return Err(format!(
                            "found `{word}` in its line {}, expected the number of a corner before it",
                            k + 1
                        ));
                    };
                    face.push(place);
                }
                into.fan(&face)?;
            }
            Some(_) | None => {}
        }
    }
    into.into_triangles()
}

/// The index of a vertex such as `7/1/2`, from 1, or from the end if it is negative.
fn index(word: &str, count: usize) -> Option<usize> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let index = if number < 0 { i64::try_from(count).ok()?.checked_add(number)? } else { number - 1 };
    usize::try_from(index).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_become_triangles() {
        let text = "# a square\nv 0 0 0\nv 1 0 0 1.0\nvt 0 0\nv 1 1 0\nv 0 1 0\nf 1/1/1 2//2 3 -1\n";
        let found = triangles(text, Collector::new([2.0, 1.0, 1.0], 10)).unwrap();
        let [a, b, c, d] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(found, [[a, b, c], [a, c, d]]);
        for (text, said) in [
            ("v 1 2\n", "line 1"),
            ("v 1 2 3\nf 1 1 2\n", "`2` in its line 2"),
            ("f 0 0 0\n", "`0`"),
            ("v 1 2 3", "no triangles"),
        ] {
            let reason = triangles(text, Collector::new([1.0; 3], 10)).unwrap_err();
            assert!(reason.contains(said), "{reason}");
        }
        assert!(triangles(&format!("v 1 2 3\nf {} 1 1\n", i64::MIN), Collector::new([1.0; 3], 10)).is_err());
    }
}
