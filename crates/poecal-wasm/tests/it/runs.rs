//! Runs of the program, and requests as bytes.

use poecal_wasm::{RunRequest, decode, run};

const ROBOT: &str = include_str!("../../../../examples/elbow/robot.urdf");
const POINTS: &str = include_str!("../../../../examples/elbow/points.csv");

fn request(words: &str, more: &[(&str, &str)]) -> RunRequest {
    let files = [("robot.urdf", ROBOT), ("points.csv", POINTS)].iter().chain(more);
    RunRequest {
        words: words.split_whitespace().map(str::to_owned).collect(),
        input: Vec::new(),
        files: files.map(|(path, text)| ((*path).to_owned(), (*text).into())).collect(),
    }
}

#[test]
fn a_calibration_writes_its_files_and_leaves_no_others() {
    let answer = run(request("calibrate robot.urdf points.csv --out out", &[]));
    assert_eq!((answer.said.code, answer.said.err.as_str()), (0, ""));
    let names: Vec<&String> = answer.written.keys().collect();
    assert_eq!(names, ["out/calibrated.urdf", "out/calibration.json", "out/report.html", "out/residuals.csv"]);
    assert!(answer.removed.is_empty());
}

#[test]
fn a_refusal_writes_nothing() {
    let answer = run(request("calibrate robot.urdf points.csv --out out", &[("out/notes.txt", "mine")]));
    assert_eq!(answer.said.code, 2);
    assert!(answer.said.err.contains("the output folder exists"), "{}", answer.said.err);
    assert!(answer.written.is_empty() && answer.removed.is_empty());
}

#[test]
fn files_of_one_path_are_refused() {
    let answer = run(request("check robot.urdf points.csv", &[("./robot.urdf", "other")]));
    assert_eq!(answer.said.code, 2);
    assert!(answer.said.err.contains("./robot.urdf: the file cannot be put on the disk"), "{}", answer.said.err);
}

#[test]
fn bytes_that_are_cut_anywhere_are_no_request() {
    let mut bytes = Vec::new();
    let block = |bytes: &mut Vec<u8>, text: &str| {
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
    };
    bytes.extend(2_u32.to_le_bytes());
    block(&mut bytes, "check");
    block(&mut bytes, "robot.urdf");
    block(&mut bytes, "input");
    bytes.extend(1_u32.to_le_bytes());
    block(&mut bytes, "robot.urdf");
    block(&mut bytes, "<robot/>");
    let whole = decode(&bytes).unwrap();
    assert_eq!((whole.words.len(), whole.input.as_slice(), whole.files.len()), (2, b"input".as_slice(), 1));
    for end in 0..bytes.len() {
        assert_eq!(decode(&bytes[..end]), None, "{end}");
    }
    bytes.push(0);
    assert_eq!(decode(&bytes), None, "a byte too many");
    // A length beyond the end, and a text that is not valid.
    assert_eq!(decode(&[1, 0, 0, 0, 255, 255, 255, 255, b'a']), None);
    assert_eq!(decode(&[1, 0, 0, 0, 1, 0, 0, 0, 0xff, 0, 0, 0, 0, 0, 0, 0, 0]), None);
}
