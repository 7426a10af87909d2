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
        folder.run_to_success(&format!("simulate robot.urdf --kind point --count 30 --seed {robot} --out made{robot}"));
        let text = folder.read(&format!("made{robot}/measurements.csv"));
        std::fs::create_dir_all(folder.path(&format!("inbox/SN{robot}"))).unwrap();
        folder.write(&format!("inbox/SN{robot}/2026-01-0{}.csv", robot + 1), text);
    }
    folder
}

fn ledger(folder: &Folder) -> Vec<String> {
    let lines = folder.read("fleet.jsonl");
    // Only the time differs.
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

/// Independent of the current folder, the ledger has the same paths, and nothing is done twice.
#[test]
fn paths_are_from_the_station() {
    let folder = line(2);
    folder.run("fleet station.toml");
    let whole = ledger(&folder);
    assert!(whole[0].contains("\"file\":\"inbox/SN0/2026-01-01.csv\""), "{}", whole[0]);
    let run = folder.run(&format!("fleet {}", folder.path("station.toml").display()));
    assert_eq!((run.code, ledger(&folder)), (0, whole), "{}", run.err);
}

#[test]
fn a_file_that_came_with_other_bytes_is_refused_and_repeated_by_again() {
    let folder = line(1);
    folder.run("fleet station.toml");
    let other = folder.read("inbox/SN0/2026-01-01.csv") + "\n";
    folder.write("inbox/SN0/2026-01-01.csv", other);
    let run = folder.run("fleet station.toml");
    assert!(run.code == 1 && run.err.contains("again with other bytes"), "{}", run.err);
    assert_eq!(ledger(&folder).len(), 2);
    assert_eq!(folder.run("fleet station.toml --rerun").code, 0);
}

#[test]
fn a_serial_number_that_is_no_name_of_a_folder_is_a_row_with_its_sentence() {
    let folder = line(1);
    let text = folder.read("inbox/SN0/2026-01-01.csv");
    std::fs::create_dir_all(folder.path("inbox/..SN1")).unwrap();
    folder.write("inbox/..SN1/2026-01-02.csv", text);
    let run = folder.run("fleet station.toml");
    assert!(run.code == 1 && run.err.contains("rename the file"), "{}", run.err);
    assert_eq!(std::fs::read_dir(folder.path("results")).unwrap().count(), 1);
}

#[test]
fn limits_are_of_a_figure_and_in_its_unit() {
    let folder = line(1);
    folder.run("fleet station.toml");
    for (limit, expected) in [
        ("\"joint2.offset[mm]\" = [-1.0, 1.0]", "in mm, expected deg"),
        ("\"joint9.offset\" = [-1.0, 1.0]", "no figure of the line"),
        ("\"error\" = [0.3, 0.1]", "the lower one first"),
    ] {
        folder.write("station.toml", format!("{STATION}\n[limits]\n{limit}\n"));
        let run = folder.run("fleet report station.toml");
        assert!(run.code == 2 && run.err.contains(expected), "{limit}: {}", run.err);
        assert!(!folder.path("fleet.html").exists() && !folder.path("fleet.csv").exists());
    }
    for limit in ["\"joint2.offset[deg]\" = [-1.0, 1.0]", "\"error\" = [-inf, 0.3]"] {
        folder.write("station.toml", format!("{STATION}\n[limits]\n{limit}\n"));
        assert_eq!(folder.run("fleet report station.toml --force").code, 0);
    }
}

/// The prior of the line is used for all robots but those that are measured in full, and it is in the ledger and in the report.
#[test]
fn the_prior_of_a_line_is_written_and_used() {
    let folder = line(3);
    let run = folder.run("fleet prior station.toml");
    assert_eq!(run.code, 2, "no ledger: {}", run.out);
    folder.run("fleet station.toml");
    let run = folder.run("fleet prior station.toml");
    assert!(run.code == 2 && run.err.contains("expected at least 30"), "{}", run.err);
    // The same robots with other serial numbers and files make a line.
    let rows: Vec<String> = folder.read("fleet.jsonl").lines().map(str::to_owned).collect();
    let other = |k: usize| {
        let row = rows[k % 3].replace("\"serial\":\"SN", &format!("\"serial\":\"A{k}B"));
        row.replace("\"sha256\":\"", &format!("\"sha256\":\"{k}")) + "\n"
    };
    let many = (0..36).map(other);
    folder.write("fleet.jsonl", many.collect::<String>());
    let prior = folder.run("fleet prior station.toml");
    assert_eq!(prior.code, 0, "{}", prior.err);
    assert!(prior.out.contains("tolerance = \"") && prior.out.contains("corrections = \""), "{}", prior.out);
    folder.write("prior.toml", prior.out);
    folder.write("station.toml", format!("prior = \"prior.toml\"\n{STATION}"));
    assert_eq!(folder.run("fleet station.toml").code, 0);
    let rows = ledger(&folder);
    let own = |serial: &str| rows.iter().find(|row| row.contains(&format!("\"serial\":\"{serial}\""))).unwrap();
    // Twenty divides zero: it is measured in full.
    assert!(own("SN0").contains("\"by_prior\":false") && own("SN1").contains("\"by_prior\":true"));
    assert!(own("SN1").contains("prior.toml") && !own("SN0").contains("prior.toml"));
    let run = folder.run("fleet report station.toml");
    assert!(run.out.contains("2 robots by the prior of the line"), "{}{}", run.out, run.err);
    folder.write("prior.toml", "poecal_settings = 1\nseed = 3\n");
    let run = folder.run("fleet station.toml");
    assert!(run.code == 2 && run.err.contains("prior.toml:2"), "{}", run.err);
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

/// The clock of the station jumped back: finished robots are not done again, and the report is in the order of measurement, the same to the last
/// byte.
#[test]
fn a_clock_that_jumped_changes_neither_what_is_done_nor_the_report() {
    let folder = line(3);
    folder.run_to_success("fleet station.toml");
    folder.run_to_success("fleet report station.toml");
    let page = folder.read("fleet.html");
    let mut year = 2031;
    let lines: Vec<String> = folder
        .read("fleet.jsonl")
        .lines()
        .map(|line| {
            let (before, after) = line.split_once("\"time\":\"").unwrap();
            let rest = after.split_once('"').unwrap().1;
            year -= 10;
            format!("{before}\"time\":\"{year}-01-01T00:00:00Z\"{rest}")
        })
        .collect();
    folder.write("fleet.jsonl", lines.join("\n") + "\n");
    let run = folder.run("fleet station.toml");
    assert_eq!(run.code, 0, "{}", run.err);
    assert_eq!(folder.read("fleet.jsonl").lines().count(), 3, "{}", run.out);
    folder.run_to_success("fleet report station.toml --force");
    assert_eq!(folder.read("fleet.html"), page);
}

/// Two visits of each of some robots: halves of one session each.
fn two_visits(count: usize) -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", crate::session::ROBOT);
    folder.write("station.toml", STATION);
    for robot in 0..count {
        folder.run_to_success(&format!(
            "simulate robot.urdf --kind point --count 60 --seed {robot} --errors 0.05deg,0.3mm --out made{robot}"
        ));
        let text = folder.read(&format!("made{robot}/measurements.csv"));
        let mut lines = text.lines().skip_while(|it| it.starts_with('#'));
        let header = lines.next().unwrap();
        let rows: Vec<&str> = lines.collect();
        std::fs::create_dir_all(folder.path(&format!("inbox/SN{robot}"))).unwrap();
        for (date, part) in
            [(format!("2026-03-0{}", robot + 1), &rows[..30]), (format!("2026-09-0{}", robot + 1), &rows[30..])]
        {
            folder.write(&format!("inbox/SN{robot}/{date}.csv"), format!("{header}\n{}\n", part.join("\n")));
        }
    }
    folder
}

#[test]
fn robots_that_were_exchanged_are_named_by_the_ledger_and_others_are_not() {
    let folder = two_visits(3);
    let run = folder.run("fleet station.toml");
    assert!(!run.err.contains("exchanged"), "{}", run.err);
    // The second visit of the first robot under the number of the second one, and vice versa.
    let folder = two_visits(3);
    let (first, second) = ("inbox/SN0/2026-09-01.csv", "inbox/SN1/2026-09-02.csv");
    let (one, other) = (folder.read(first), folder.read(second));
    folder.write(first, other);
    folder.write(second, one);
    let run = folder.run("fleet station.toml");
    println!("{}{}", run.out, run.err);
    let words = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(run.code, 1);
    assert!(
        words.contains("SN0 2026-09-01: found a robot whose tip is")
            && words.contains("where SN1 had it on 2026-03-02"),
        "{words}"
    );
    assert!(
        words.contains("SN1 2026-09-02: found a robot whose tip is")
            && words.contains("where SN0 had it on 2026-03-01"),
        "{words}"
    );
    assert!(!words.contains("SN2"), "{words}");
    let run = folder.run("fleet report station.toml");
    println!("{}", run.out);
    assert!(run.out.contains("robots      3, ") && run.out.contains("; 6 measurements in all"), "{}", run.out);
    assert_eq!(run.out.lines().filter(|it| it.starts_with("another     SN")).count(), 2);
    // Under its own number each is recognised again.
    for (path, number) in [(first, 0), (second, 1)] {
        std::fs::remove_file(folder.path(path)).unwrap();
        let made = folder.read(&format!("made{number}/measurements.csv"));
        let rows: Vec<&str> = made.lines().skip_while(|it| it.starts_with('#')).collect();
        let text = format!("{}\n{}\n", rows[0], rows[31..].join("\n"));
        folder.write(&format!("inbox/SN{number}/2026-10-01.csv"), text);
    }
    let run = folder.run("fleet station.toml");
    assert!(run.code == 0 && !run.err.contains("exchanged"), "{}{}", run.out, run.err);
}

#[test]
fn one_file_under_two_serial_numbers_is_refused_under_the_second() {
    let folder = line(2);
    let text = folder.read("inbox/SN0/2026-01-01.csv");
    std::fs::create_dir_all(folder.path("inbox/SN7")).unwrap();
    folder.write("inbox/SN7/2026-01-09.csv", text);
    let run = folder.run("fleet station.toml");
    println!("{}", run.err);
    let words = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(run.code, 1);
    assert!(words.contains("SN7 2026-01-09: found the same bytes as `inbox/SN0/2026-01-01.csv` of SN0"), "{words}");
    assert!(!words.contains("SN0 2026-01-01: ") && !folder.path("results/SN7").exists());
    // It was a copy of the second one's: it is calibrated once the first one is gone.
    std::fs::remove_file(folder.path("inbox/SN0/2026-01-01.csv")).unwrap();
    std::fs::remove_file(folder.path("fleet.jsonl")).unwrap();
    let run = folder.run("fleet station.toml");
    assert!(run.code == 0 && run.out.contains("2 of 2 robots passed"), "{}{}", run.out, run.err);
    std::fs::remove_file(folder.path("inbox/SN7/2026-01-09.csv")).unwrap();
    // Beside a robot that is already done only the copy is refused.
    folder.write("inbox/SN7/2026-01-09.csv", folder.read("inbox/SN1/2026-01-02.csv"));
    let run = folder.run("fleet station.toml");
    assert!(run.code == 1 && run.err.contains("SN7 2026-01-09") && !run.err.contains("SN1 2026"), "{}", run.err);
}
