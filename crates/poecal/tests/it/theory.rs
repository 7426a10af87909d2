//! docs/theory.md: identities that no code uses in just that form, and a check that the equations cited by the code exist.

use nalgebra::{Matrix6, Vector3};
use poecal_arm::lie::{Pose, Screw, Twist};
use std::fs;
use std::path::{Path, PathBuf};

fn project_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// (4a): the two coefficients of the inverse left Jacobian.
#[test]
fn inverse_left_jacobian_has_the_stated_coefficients() {
    for angle in [0.3, 1.0, 3.0, 3.13, 5.5] {
        let twist = Twist::new(Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.6, -0.48, 0.64) * angle);
        let half = 0.5 * angle;
        let gamma = half / half.tan();
        let slope = 0.5 / half.tan() - 0.5 * half / half.sin().powi(2);
        let b2 = slope / (2.0 * angle) - 2.0 * (gamma - 1.0) / angle.powi(2);
        let b4 = (gamma - 1.0) / angle.powi(4) + b2 / angle.powi(2);
        let ad = twist.adjoint_matrix();
        let ad2 = ad * ad;
        let inverse = Matrix6::identity() - ad * 0.5 + ad2 * b2 + ad2 * ad2 * b4;
        let error = (inverse * twist.left_jacobian() - Matrix6::identity()).norm();
        println!("angle {angle}: {error:.1e}");
        // At 0.3 rad the coefficients lose four digits to cancellation.
        assert!(error < 1e-12);
    }
}

/// (22c): normalising a twist and changing its frame commute.
#[test]
fn normalisation_does_not_depend_on_the_frame() {
    let pose = Pose::from_xyz_rpy([0.4, -1.0, 2.0], [0.3, -0.8, 2.5]);
    let twist = Twist::new(Vector3::new(0.3, -0.7, 0.2), Vector3::new(0.5, 0.4, -0.9));
    let there = Screw::project(&pose.transform(&twist)).unwrap();
    let back = Screw::project(&twist).unwrap().transform(&pose);
    assert!((there.twist().to_vector() - back.twist().to_vector()).norm() < 1e-14);
}

/// All Rust files of a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// Section of each equation of theory.md: `("(22a)", "5")`.
fn equations(theory: &str) -> Vec<(String, String)> {
    let mut section = String::new();
    let mut equations = Vec::new();
    for line in theory.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            section = title.split(' ').next().unwrap_or_default().to_owned();
        } else if let Some(tag) = line.trim().strip_prefix("\\tag{") {
            equations.push((format!("({})", tag.trim_end_matches('}')), section.clone()));
        }
    }
    equations
}

/// Citations after "theory.md §" in a line: the section, and the equations named after it.
fn citations(line: &str) -> Vec<(String, Vec<String>)> {
    line.split("theory.md §")
        .skip(1)
        .map(|rest| {
            let section: String = rest.chars().take_while(char::is_ascii_digit).collect();
            let mut named = Vec::new();
            let mut rest = rest[section.len()..].trim_start_matches([' ', ',']);
            while let Some(end) = rest.starts_with('(').then(|| rest.find(')')).flatten() {
                named.push(rest[..=end].to_owned());
                rest = rest[end + 1..].trim_start_matches([' ', ',']);
                rest = rest.strip_prefix("and ").or(rest.strip_prefix("to ")).unwrap_or(rest);
            }
            (section, named)
        })
        .collect()
}

#[test]
fn cited_equations_exist_in_the_section_that_is_named() {
    let theory = fs::read_to_string(project_folder().join("docs/theory.md")).unwrap();
    let equations = equations(&theory);
    let mut cited = 0;
    let this_file = Path::new(file!()).file_name();
    for file in sources(&project_folder().join("crates")) {
        if file.file_name() == this_file {
            continue;
        }
        for line in fs::read_to_string(&file).unwrap().lines() {
            for (section, named) in citations(line) {
                assert!(theory.contains(&format!("\n## {section} ")), "{}: {line}", file.display());
                for equation in named {
                    let known = equations.contains(&(equation, section.clone()));
                    assert!(known, "{}: {line}", file.display());
                    cited += 1;
                }
            }
        }
    }
    println!("{cited} citations of {} equations", equations.len());
    for (k, (equation, _)) in equations.iter().enumerate() {
        assert!(equations[..k].iter().all(|(other, _)| other != equation), "{equation} stands twice");
    }
    assert!(cited > 30);
}

/// The last column of the table "the paper's equations" names tests of the project.
#[test]
fn named_tests_exist() {
    let theory = fs::read_to_string(project_folder().join("docs/theory.md")).unwrap();
    let (_, table) = theory.split_once("### The paper's equations").unwrap();
    let code: String =
        sources(&project_folder().join("crates")).iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let mut named = 0;
    for row in table.lines().take_while(|line| !line.starts_with("## ")).filter(|line| line.starts_with('|')) {
        let tests = row.trim_end_matches([' ', '|']).rsplit('|').next().unwrap_or_default();
        for name in tests.split('`').skip(1).step_by(2) {
            let exists = if name.contains('/') {
                project_folder().join("crates").join(name).is_file()
            } else {
                code.contains(&format!("fn {name}()"))
            };
            assert!(exists, "theory.md names a test `{name}`, which does not exist");
            named += 1;
        }
    }
    println!("{named} tests named");
    assert!(named > 20);
}
