//! Programs of robots, compensated.

use poecal_arm::lie::Pose;
use poecal_compensate::{Language, ProgramOptions, compensate_program};
use poecal_model::robot::{JointTerm, Term};
use poecal_model::simulate::elbow;

use crate::LONGEST;
use crate::properties::{check_result, one_line};

/// True for a character of a number: all other characters of a program must stay unchanged.
fn is_of_number(byte: u8) -> bool {
    byte.is_ascii_digit() || b".+-eE".contains(&byte)
}

/// A line with the language (`urscript`, `rapid`, `krl`, `fanuc`), and the program in it: text other than numbers stays, repetition is equal, and
/// each unchanged target has its reason in a line.
pub fn programs(data: &[u8]) -> bool {
    if data.len() > LONGEST {
        return false;
    }
    let Some(end) = data.iter().position(|byte| *byte == b'\n') else { return false };
    let language = match &data[..end] {
        b"urscript" => Language::UrScript,
        b"rapid" => Language::Rapid,
        b"krl" => Language::Krl,
        b"fanuc" => Language::Fanuc,
        _ => return false,
    };
    let text = &data[end + 1..];
    let nominal = elbow();
    let mut actual = nominal.clone();
    actual.terms.push(JointTerm { joint: 1, term: Term::OFFSET, coefficient: 0.003 });
    let mut options = ProgramOptions::new(language);
    options.change.nearest = text.len().is_multiple_of(2);
    options.given.tools.push((None, Pose::from_translation([0.0, 0.0, 0.1].into())));
    options.given.frames.push((None, Pose::identity()));
    options.given.frames.push((Some("1".to_owned()), Pose::from_translation([0.1, 0.0, 0.0].into())));
    let words = String::from_utf8_lossy(text);
    let made = || check_result(compensate_program(text, (&nominal, &actual), &[], &options), &words);
    let Some((out, summary)) = made() else { return false };
    assert_eq!(made().map(|it| it.0), Some(out.clone()));
    let bare = |text: &[u8]| text.iter().copied().filter(|byte| !is_of_number(*byte)).collect::<Vec<u8>>();
    assert_eq!(bare(&out), bare(text));
    assert!(summary.corrected > 0 || out == text);
    summary.changes.listed.iter().for_each(|it| one_line(&it.reason));
    true
}
