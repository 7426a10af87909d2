//! `poecal fleet` as users run it.

use crate::folder::Folder;

const STATION: &str = r#"
poecal_station = 1
inbox = "inbox/{serial}/{date}.csv"
results = "results/{serial}/{date}"
model = "robot.urdf"
"#;

/// A line of some robots, and one whose file is broken.
fn line(count: usize) -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", crate::session::ROBOT);
    folder.write("station.toml", STATION);
    for robot in 0..count {
        folder.done(&format!("simulate robot.urdf --kind point --count 30 --seed {robot} --out made{robot}"));
        let text = folder.read(&format!("made{robot}/measurements.csv"));
        std::fs::create_dir_all(folder.path(&format!("inbox/SN{robot}"))).unwrap();
        folder.write(&format!("inbox/SN{robot}/2026-01-0{}.csv", robot + 1), text);
    }
    folder
}

fn ledger(folder: &Folder) -> Vec<String> {
    let lines = folder.read("fleet.jsonl");
    // The time alone is another.
    let without = |line: &str| {
        let (before, after) = line.split_once("\"time\":\"").unwrap();
        format!("{before}{}", after.split_once('"').unwrap().1)
    };
    lines.lines().map(without).collect()
}

#[test]
fn a_line_is_worked_off_once_and_restarts_where_it_was() {
    let folder = line(3);
    folder.write("inbox/SN1/2026-01-02.csv", "nothing\n");
    let run = folder.run("fleet station.toml");
    assert_eq!(run.code, 1, "{}{}", run.out, run.err);
    assert!(run.err.contains("SN1"), "{}", run.err);
    let whole = ledger(&folder);
    assert_eq!(whole.len(), 3);
    assert!(whole[1].contains("\"exit\":2") && !folder.path("results/SN1/2026-01-02").exists());
    // Nothing is done twice.
    folder.run("fleet station.toml");
    assert_eq!(ledger(&folder), whole);
    // Killed at any byte of the ledger, the rest is done again and the ledger is the same.
    let text = folder.read("fleet.jsonl");
    for cut in [0, 1, text.len() / 3, text.len() / 2, text.len() - 1] {
        folder.write("fleet.jsonl", &text[..cut]);
        folder.run("fleet station.toml");
        assert_eq!(ledger(&folder), whole, "cut at {cut}");
    }
    let run = folder.run("fleet report station.toml");
    assert_eq!(run.code, 0, "{}", run.err);
    assert!(run.out.contains("2 of 3 passed"), "{}", run.out);
    let page = folder.read("fleet.html");
    folder.run("fleet report station.toml --force");
    assert_eq!(folder.read("fleet.html"), page);
    assert_eq!(folder.read("fleet.csv").lines().count(), 4);
}

#[test]
fn parts_concatenate_to_the_whole() {
    let folder = line(4);
    folder.run("fleet station.toml");
    let mut whole = ledger(&folder);
    for part in 1..=2 {
        folder.run(&format!("fleet station.toml --shard {part}/2"));
    }
    let parts = folder.read("fleet.1-of-2.jsonl") + &folder.read("fleet.2-of-2.jsonl");
    folder.write("fleet.jsonl", parts);
    let mut parts = ledger(&folder);
    whole.sort();
    parts.sort();
    assert_eq!(parts, whole);
}

#[test]
fn a_station_that_is_none_is_refused_in_a_sentence() {
    let folder = Folder::new();
    for (text, expected) in [
        ("inbox = 1\n", "station.toml:1"),
        (&STATION.replace("{serial}/{date}.csv", "{date}.csv"), "{serial} once"),
        (&STATION.replace("results/{serial}/{date}", "results/{serial}"), "{date} in both"),
        (&STATION.replace("poecal_station = 1", "poecal_station = 2"), "a newer poecal"),
        (&(STATION.to_owned() + "speed = 3\n"), "unknown field `speed`"),
    ] {
        folder.write("station.toml", text);
        let run = folder.run("fleet station.toml");
        assert_eq!(run.code, 2, "{}", run.out);
        assert!(run.err.contains(expected) && run.err.lines().count() == 1, "{}", run.err);
    }
    folder.write("station.toml", STATION);
    folder.write("robot.urdf", crate::session::ROBOT);
    std::fs::create_dir_all(folder.path("inbox")).unwrap();
    folder.write("fleet.jsonl", "{\"schema\":\"poecal-fleet-2\"}\n");
    let run = folder.run("fleet station.toml");
    assert!(run.code == 2 && run.err.contains("a newer poecal wrote it"), "{}", run.err);
}
