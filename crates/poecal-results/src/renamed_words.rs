//! Old words of commands, options and settings, each with the new one: the table *Names that changed* of CHANGELOG.md.

/// Commands with an old word (empty: the program itself), the old word, and the new one.
pub const RENAMED: [(&str, &str, &str); 41] = [
    ("", "apply", "export CALIBRATION --onto URDF"),
    ("", "board", "detect --print BOARD"),
    ("", "certificate", "report CALIBRATION --certificate"),
    ("", "convert", "export MODEL --format FORM"),
    ("", "identify", "plan MODEL --rows FILE"),
    ("calibrate check plan simulate watch", "--frame", "--device-frame"),
    ("predict", "--frame", "--output-frame"),
    ("compensate", "--frame", "--work-object"),
    ("calibrate check import validate track", "--frames", "--device-frames"),
    ("hand-eye", "--frames", "--frame-names"),
    ("hand-eye tcp", "--model", "--robot"),
    ("compensate", "--tool", "--tool-data"),
    ("compensate", "--base", "--controller-base"),
    ("compensate", "--flange", "--controller-flange"),
    ("compensate", "--factor", "--factors"),
    ("compensate", "--most-change", "--max-correction"),
    ("calibrate check import", "--fit-where", "--train-where"),
    ("plan", "--for", "--purpose"),
    ("plan watch", "--over", "--workspace"),
    ("plan", "--keep", "--keep-rows"),
    ("plan", "--measured", "--keep-rows"),
    ("plan", "--replace", "--replace-rows"),
    ("plan", "--judge", "--held-out-count"),
    ("plan", "--floor", "--floor-height"),
    ("plan", "--cone", "--device-half-angle"),
    ("plan", "--device-looks-at", "--device-aim"),
    ("plan", "--acceptance", "--target-half-angle"),
    ("plan", "--facing", "--target-normal"),
    ("plan track", "--device anew", "--device refit"),
    ("plan track", "--tool anew", "--tool refit"),
    ("validate", "--refit-frame", "--refit device"),
    ("validate", "--refit-tool", "--refit tool"),
    ("offsets", "--base", "--free base"),
    ("offsets", "--tip", "--free tip"),
    ("watch", "--until", "--target-error"),
    ("watch", "--once", "--batch"),
    ("init plan simulate", "--measure", "--kind"),
    ("fleet", "--again", "--rerun"),
    ("detect", "--page", "--paper"),
    ("report", "--valid-until", "--record valid_until=DATE"),
    ("export", "--to", "--format"),
];

/// The new word of a command, or of an option of a command.
#[must_use]
pub fn new_word(command: &str, old: &str) -> Option<&'static str> {
    let is_it = |(commands, word, _): &&(&str, &str, &str)| {
        *word == old
            && (commands.is_empty() == command.is_empty())
            && (command.is_empty() || commands.split(' ').any(|it| it == command))
    };
    RENAMED.iter().find(is_it).map(|(.., new)| *new)
}

/// The new name of a key or keyword, with underscores, among these.
#[must_use]
pub fn new_key<'a>(old: &str, keys: &[&'a str]) -> Option<&'a str> {
    let option = format!("--{}", old.replace('_', "-"));
    let new = RENAMED
        .iter()
        .filter(|(_, word, _)| *word == option)
        .map(|(.., new)| new.trim_start_matches("--").replace('-', "_"));
    new.into_iter().find_map(|new| keys.iter().copied().find(|key| *key == new))
}
