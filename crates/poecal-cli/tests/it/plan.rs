//! `poecal plan` and `poecal watch`.

use crate::folder::Folder;
use crate::offsets::COLUMN;
use crate::session::ROBOT;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("column.toml", COLUMN);
    folder
}

/// The list is a measurement file without measured columns: the readers of joints accept it, and so does a plan.
#[test]
fn a_planned_list_is_read_and_completed() {
    let folder = folder();
    let out =
        folder.run_to_success("plan column.toml --count 12 --held-out-count 4 --out joints.csv --robot-error 0.1mm");
    for words in [
        "planned       12 configurations to fit, 4 at random to judge by, 0 returns to\n",
        "expected      ",
        "robot error   0.1000 mm that no geometry of the axes describes\n",
        "NOT collisions of the robot with itself",
        "  12  planned",
        "advice        ",
    ] {
        assert!(out.contains(words), "`{words}` is not in\n{out}");
    }
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    let text = folder.read("joints.csv");
    let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(rows[0], "id,set,returns,turn[deg],slide[mm],nod[deg]");
    let of = |set: &str| rows.iter().filter(|row| row.split(',').nth(1) == Some(set)).count();
    assert_eq!((of("fit"), of("held_out"), rows.len()), (12, 4, 17));
    folder.run_to_success("plan column.toml --rows joints.csv --kind point");
    // Four more beside these, the same bytes for any number of threads.
    let more = |threads: usize| {
        folder.run_to_success(&format!(
            "plan column.toml --count 20 --held-out-count 0 --keep-rows joints.csv --json --threads {threads}"
        ))
    };
    let one = more(1);
    assert_eq!(one, more(3));
    let found: serde_json::Value = serde_json::from_str(&one).unwrap();
    // Rows for validation do not count.
    assert_eq!((&found["kept"], &found["configurations"]), (&12.into(), &8.into()));
    let calibrated = |of: &str| found[of]["calibrated_mm"].as_f64().unwrap();
    println!("expected {} mm, random {} mm", calibrated("expected"), calibrated("random"));
    assert!(calibrated("expected") <= calibrated("random"));
}

/// Rows that could not be measured are replaced, and all others are unchanged.
#[test]
fn replaced_rows_leave_the_others_in_their_places() {
    let folder = folder();
    folder.run_to_success("plan column.toml --count 12 --held-out-count 8 --out joints.csv --robot-error 0.1mm,0.05mm");
    let before = folder.read("joints.csv");
    let out = folder.run_to_success(
        "plan column.toml --keep-rows joints.csv --replace-rows 3,15 --out better.csv --report plan.html",
    );
    assert!(out.contains("1 configurations to fit beside 11 kept ones, 8 at random"), "{out}");
    let rows =
        |text: &str| -> Vec<String> { text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned).collect() };
    let (before, after) = (rows(&before), rows(&folder.read("better.csv")));
    let changed: Vec<usize> = (0..before.len()).filter(|&row| before[row] != after[row]).collect();
    println!("changed lines {changed:?} of {}", before.len());
    // Line 0 has the names. The set of each row stays.
    assert_eq!((changed, after.len()), (vec![3, 15], before.len()));
    let set = |row: &str| row.split(',').nth(1).map(str::to_owned);
    assert!(before.iter().zip(&after).all(|(a, b)| set(a) == set(b)));
    let page = folder.read("plan.html");
    for words in ["The robot and its targets", "How each joint is sampled", "From above"] {
        assert!(page.contains(words), "{words}");
    }
    // Two pictures of eight arms at most, of three joints each, and the targets of all 20 configurations.
    let arms = page.matches("stroke-opacity=\"0.4\"").count();
    assert!(arms > 0 && arms <= 2 * 8 * 5, "{arms}");
    assert!(page.contains("the target in all 20 configurations"));
    let run = folder.run("plan column.toml --keep-rows joints.csv --replace-rows 99 --out no.csv");
    assert!(run.code == 2 && run.err.contains("found row 99 to replace, expected one of the"), "{}", run.err);
}

#[test]
fn what_cannot_be_planned_is_refused_with_a_reason() {
    let folder = folder();
    let refused = |arguments: &str| {
        let run = folder.run(arguments);
        assert_eq!(run.code, 2, "{}", run.err);
        run.err
    };
    let err = refused("plan column.toml --count 12 --device 0,0,90000mm --distance 1mm:2mm --out joints.csv");
    assert!(err.contains("by the device's distances, expected at least the 12 of the plan"), "{err}");
    let err = refused("plan column.toml --kind socket --out joints.csv");
    assert!(err.contains("found the kind `socket`, expected one whose configurations can be chosen freely"), "{err}");
    let err = refused("plan column.toml --keep-out 1,2,3 --out joints.csv");
    assert!(err.contains("expected two corners with a unit behind the last"), "{err}");
    assert!(!folder.path("joints.csv").exists());
}

/// Rows of a finished file, one of them with an error of 10 mm.
#[test]
fn a_row_that_is_off_is_named() {
    let folder = folder();
    folder.run_to_success("simulate column.toml --kind point --count 30 --out made");
    let text = folder.read("made/measurements.csv");
    let clean = folder.run("watch column.toml made/measurements.csv --batch --json --robot-error 0.05mm");
    println!("{}", clean.out.lines().last().unwrap());
    assert_eq!((clean.code, clean.out.lines().count()), (0, 30), "{}{}", clean.out, clean.err);
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let at = lines.len() - 5;
    let mut cells: Vec<String> = lines[at].split(',').map(str::to_owned).collect();
    let x: f64 = cells[3].parse().unwrap();
    cells[3] = format!("{}", x + 10.0);
    lines[at] = cells.join(",");
    folder.write("off.csv", lines.join("\n") + "\n");
    let run = folder.run("watch column.toml off.csv --batch --robot-error 0.05mm");
    assert_eq!(run.code, 1);
    assert!(run.out.contains("row 26: WRONG"), "{}", run.out);
}

/// Chosen configurations keep 2 deg from the limits and one turn; a stated margin is respected, and limits that no robot has are named.
#[test]
fn configurations_stay_within_a_turn_and_away_from_the_limits() {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    let planned = |words: &str| {
        let run =
            folder.run(&format!("plan robot.urdf --count 40 --held-out-count 20 --force --out joints.csv {words}"));
        assert_eq!(run.code, 0, "{}", run.err);
        let text = folder.read("joints.csv");
        let rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
        let of = |row: &str| row.split(',').skip(3).map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>();
        let rows: Vec<Vec<f64>> = rows.map(of).collect();
        let extreme = |joint: usize| {
            rows.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], it| [a.min(it[joint]), b.max(it[joint])])
        };
        (run, [extreme(1), extreme(5)])
    };
    let (usual, [second, sixth]) = planned("");
    assert!(usual.out.contains("limits of more than a turn, taken within one: joint6"), "{}", usual.out);
    // Limits of -105 to 175 deg; planned lists go to the ends.
    assert!(second[0] >= -103.0 && second[1] <= 173.0 && second[0] < -95.0, "{second:?}");
    assert!(sixth[0] >= -180.0 && sixth[1] <= 180.0, "{sixth:?}");
    let (_, [second, _]) = planned("--margin 20deg,0mm");
    assert!(second[0] >= -85.0 && second[1] <= 155.0, "{second:?}");
    assert!(!usual.err.contains("placeholders"), "{}", usual.err);
    // Every joint by 401 deg to either side, as in exported models without stated limits.
    let wide: Vec<String> = ROBOT
        .lines()
        .map(|line| match line.trim_start().starts_with("<limit") {
            true => "<limit lower=\"-7\" upper=\"7\" effort=\"10\" velocity=\"1\"/>".to_owned(),
            false => line.to_owned(),
        })
        .collect();
    folder.write("robot.urdf", wide.join("\n"));
    let (run, [second, _]) = planned("");
    let words = "every joint has the limits -401 to 401 deg, which are placeholders";
    assert!(run.err.contains(words) && second[0] >= -180.0 && second[1] <= 180.0, "{second:?} {}", run.err);
    assert!(folder.run_to_success("check robot.urdf").split_whitespace().collect::<Vec<_>>().join(" ").contains(words));
}
