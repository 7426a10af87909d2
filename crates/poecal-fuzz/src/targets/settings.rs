//! Settings: `poecal.toml`.

use poecal_results::settings::{SettingValue, Settings};

use crate::properties::{PATH, certain, check_result, text};

/// Possible keys of settings: those of the examples, and some of each kind.
const KEYS: [&str; 14] = [
    "model",
    "measurements",
    "columns",
    "validate",
    "out",
    "report",
    "device_frame",
    "tip_link",
    "sigma_position",
    "sigma_rotation",
    "held_out",
    "seed",
    "train_where",
    "force",
];

/// Settings: read, written as texts, read again.
pub fn settings(data: &[u8]) -> bool {
    let Some(text) = text(data) else { return false };
    let Some(settings) = check_result(Settings::parse(&text, PATH, &KEYS), &text) else { return false };
    let mut written = "poecal_settings = 1\n".to_owned();
    for entry in &settings.entries {
        written.push_str(&format!("{} = {}\n", entry.key, value(&entry.value)));
        assert!(settings.error(entry, "found it").place().is_some());
    }
    let again = certain(Settings::parse(&written, PATH, &KEYS), &written);
    let values = |all: Settings| all.entries.into_iter().map(|entry| (entry.key, entry.value)).collect::<Vec<_>>();
    assert_eq!(values(settings), values(again), "{written}");
    true
}

fn value(value: &SettingValue) -> String {
    let quoted = |text: &String| toml::Value::String(text.clone()).to_string();
    match value {
        SettingValue::One(text) => quoted(text),
        SettingValue::Many(texts) => format!("[{}]", texts.iter().map(quoted).collect::<Vec<_>>().join(", ")),
        SettingValue::Switch(on) => on.to_string(),
    }
}
