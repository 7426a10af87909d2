//! The report of a reproduction contains the findings, in every form, and loads nothing.

use crate::findings::findings;
use poecal_lou2009::Reproduction;
use poecal_lou2009::report::reproduction_files;
use poecal_results::output::{Contents, ExistingFiles, ReservedFolder, write_reproduction};
use poecal_testing::files::Folder;

fn text(found: &Reproduction, name: &str) -> String {
    reproduction_files(found).unwrap().into_iter().find(|(other, _)| other == name).unwrap().1
}

fn plots(found: &Reproduction) -> Vec<(String, String)> {
    let files = reproduction_files(found).unwrap();
    files.into_iter().filter(|(name, _)| name.ends_with(".svg")).collect()
}

/// Findings without any entry.
fn empty_reproduction() -> Reproduction {
    Reproduction {
        runs: vec![],
        claims: vec![],
        screws: vec![],
        offsets: vec![],
        spectra: vec![],
        efficiency: vec![],
        basin: vec![],
        ..findings()
    }
}

/// Findings in which every real number is `value`.
fn all_numbers(value: f64) -> Reproduction {
    let mut found = findings();
    found.noise_position_m = value;
    found.length_m = value;
    for run in &mut found.runs {
        (run.held_out_rms_m, run.screw_error_max) = (value, value);
        for state in &mut run.trace {
            (state.residual_rms_m, state.screw_error_max) = (value, value);
        }
    }
    for row in &mut found.screws {
        (row.nominal, row.from_poses, row.from_points) = ([value; 6], [value; 6], [value; 6]);
    }
    for row in &mut found.offsets {
        row.screw_offsets_deg = value;
    }
    for spectrum in &mut found.spectra {
        spectrum.singular_values.fill(value);
    }
    for row in &mut found.efficiency {
        row.ratio = value;
    }
    for row in &mut found.basin {
        (row.error_deg, row.share) = (value, value);
    }
    found
}

fn odd_findings() -> Vec<Reproduction> {
    let odd = [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, 5e-324].map(all_numbers);
    odd.into_iter().chain([findings(), empty_reproduction()]).collect()
}

#[test]
fn every_plot_is_well_formed_and_says_what_it_is() {
    for found in odd_findings() {
        for (name, svg) in plots(&found) {
            let document = roxmltree::Document::parse(&svg).unwrap();
            let root = document.root_element();
            assert_eq!(root.attribute("role"), Some("img"), "{name}");
            for child in ["title", "desc"] {
                assert!(
                    root.children().any(|node| node.has_tag_name((root.tag_name().namespace().unwrap(), child))
                        && node.text().is_some()),
                    "{name}"
                );
            }
            for attribute in document.descendants().flat_map(|node| node.attributes()) {
                assert!(
                    !attribute.value().contains("NaN") && !attribute.value().contains("inf"),
                    "{name}: {attribute:?}"
                );
            }
        }
    }
}

#[test]
fn every_axis_has_a_unit_or_the_word_for_none() {
    const WORDS: [&str; 7] = [", mm", ", deg", ", m (v)", "no unit", "iteration", "ratio", "share"];
    for (name, svg) in plots(&findings()) {
        let document = roxmltree::Document::parse(&svg).unwrap();
        let titles: Vec<&str> = document
            .descendants()
            .filter(|node| node.attribute("class").is_some_and(|class| class.contains("axis-title")))
            .filter_map(|node| node.text())
            .collect();
        let axes = if svg.contains("<polyline") { 2 } else { 1 };
        assert_eq!(titles.len(), axes, "{name}: {titles:?}");
        for title in titles {
            let told = title.starts_with("number of") || WORDS.iter().any(|word| title.contains(word));
            assert!(told, "{name}: {title}");
        }
    }
}

#[test]
fn claims_stand_in_both_forms() {
    let found = findings();
    let html = text(&found, "report.html");
    let markdown = text(&found, "report.md");
    let escaped_html =
        |text: &str| text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    let escaped_markdown = |text: &str| text.replace('|', r"\|").replace('<', r"\<").replace('*', r"\*");
    for claim in &found.claims {
        for words in [&claim.claim, &claim.paper, &claim.measured, &claim.criterion] {
            assert!(html.contains(&format!(">{}</td>", escaped_html(words))), "{words}");
            assert!(markdown.contains(&format!("| {} |", escaped_markdown(words))), "{words}");
        }
    }
    // Findings that the paper leaves out are in a table of their own.
    for text in [&html, &markdown] {
        let at = |words: &str| text.find(words).unwrap();
        let (said, left_out) = (at("Table 1. What the paper says."), at("Table 2. What the paper leaves out."));
        assert!(said < at("Offsets add no rank") && at("Offsets add no rank") < left_out);
        assert!(left_out < at("The components of η are redundant."));
    }
    assert!(html.contains("Text | with &lt;markup&gt; &amp; &quot;quotes&quot; stays *text*."));
    assert!(markdown.contains(r"Text \| with \<markup> &"));
    // On a narrow screen each cell of such a table is labelled.
    assert!(html.contains("<td data-label=\"holds\">yes</td>"));
    assert!(html.contains("made &amp; up") && markdown.contains("    poecal reproduce lou2009 --out \"made & up\""));
    for words in ["4 of 5 statements hold", "4 iterations to 2.0e-13 mm from 20 poses"] {
        assert!(html.contains(words) && markdown.contains(words), "{words}");
    }
    assert!(html.contains("<code>adjoint</code> 4; <code>screw</code> 5;"));
    assert!(markdown.contains("`adjoint` 4; `screw` 5; `screw-offsets` 6; `adjoint-offsets` 7."));
}

#[test]
fn tables_have_equal_rows() {
    for found in odd_findings() {
        let markdown = text(&found, "report.md");
        let (mut before, mut tables) = (0, 0);
        for line in markdown.lines() {
            let bars = line.replace("\\|", "").matches('|').count();
            assert_eq!(line.starts_with('|'), bars > 0, "{line}");
            tables += usize::from(bars > 0 && before == 0);
            assert!(bars == 0 || before == 0 || bars == before, "{line}");
            before = bars;
        }
        assert_eq!(tables, 9);
    }
}

#[test]
fn the_page_loads_nothing() {
    let html = text(&findings(), "report.html").replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for word in ["http:", "https:", "<script", "<link", "<img", "src=", "href=", "url(", "@import", "javascript"] {
        assert!(!html.contains(word), "{word}");
    }
    for tag in ["table", "figure", "svg", "div", "tr", "td", "th", "p", "g"] {
        let opened = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
        assert_eq!(opened, html.matches(&format!("</{tag}>")).count(), "{tag}");
    }
}

#[test]
fn markdown_shows_every_plot_that_is_written() {
    let found = findings();
    let markdown = text(&found, "report.md");
    let names: Vec<String> = plots(&found).into_iter().map(|(name, _)| name).collect();
    assert!(names.iter().all(|name| markdown.contains(&format!("]({name})"))));
    assert_eq!(markdown.matches(".svg)").count(), names.len());
    let mut distinct = names.clone();
    distinct.sort();
    distinct.dedup();
    assert_eq!(distinct.len(), names.len());
}

#[test]
fn results_hold_the_findings_and_nulls_where_there_is_no_number() {
    let mut found = findings();
    found.runs[0].held_out_rms_m = f64::NAN;
    (found.efficiency[0].converged, found.efficiency[0].ratio) = (0, f64::NAN);
    let results: serde_json::Value = serde_json::from_str(&text(&found, "results.json")).unwrap();
    assert!(results["runs"][0]["held_out_rms_m"].is_null());
    assert!(results["efficiency"][0]["ratio"].is_null());
    assert!(text(&found, "report.md").contains("| not a number |"));
    assert_eq!(results["runs"][1]["formulation"], "adjoint");
    assert_eq!(results["claims"][2]["holds"], false);
}

#[test]
fn a_second_run_replaces_the_first_and_leaves_other_files() {
    let folder = Folder::new();
    let out = folder.path("out");
    let files = reproduction_files(&findings()).unwrap();
    let place = |existing| ReservedFolder::reserve(&out, Contents::Reproduction, existing, &[], &mut |_| ());
    let written = write_reproduction(place(ExistingFiles::Kept).unwrap(), &files).unwrap();
    assert_eq!(written.files.len(), files.len());
    std::fs::write(out.join("mine.svg"), "mine").unwrap();
    let error = place(ExistingFiles::Kept).unwrap_err();
    assert!(error.to_string().contains("--force"), "{error}");
    let fewer = reproduction_files(&empty_reproduction()).unwrap();
    write_reproduction(place(ExistingFiles::Replaced).unwrap(), &fewer).unwrap();
    let names = std::fs::read_dir(&out).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name != "mine.svg").collect();
    names.sort();
    let mut expected: Vec<String> = fewer.into_iter().map(|(name, _)| name).collect();
    expected.sort();
    assert_eq!(names, expected);
    assert_eq!(std::fs::read_to_string(out.join("mine.svg")).unwrap(), "mine");
}

/// Every key of an object and of its nested objects.
fn keys(value: &serde_json::Value, found: &mut Vec<String>) {
    match value {
        serde_json::Value::Object(object) => {
            found.extend(object.keys().cloned());
            object.values().for_each(|value| keys(value, found));
        }
        serde_json::Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        serde_json::Value::Null
        | serde_json::Value::Bool(_)
        | serde_json::Value::Number(_)
        | serde_json::Value::String(_) => {}
    }
}

#[test]
fn every_key_of_the_results_is_documented() {
    let section = include_str!("../../../../docs/lou2009/results.md");
    let results = serde_json::from_str(&text(&findings(), "results.json")).unwrap();
    let mut found = Vec::new();
    keys(&results, &mut found);
    for key in found {
        assert!(section.contains(&format!("`{key}`")), "{key}");
    }
}

#[test]
fn the_console_shows_both_tables_with_the_places() {
    let found = findings();
    let text = poecal_lou2009::report::claims(&found);
    println!("{text}");
    let (said, left_out) = text.split_once("What the paper leaves out\n").unwrap();
    let flat = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    for claim in &found.claims {
        let part = flat(if claim.said_by_paper { said } else { left_out });
        for words in [&claim.claim, &claim.paper, &claim.measured, &claim.criterion] {
            assert!(part.contains(&flat(words)), "{words}");
        }
    }
    assert!(said.contains("4 of 5 hold as they are made") && !left_out.contains("hold as they are made"));
    assert!(text.lines().all(|line| line.chars().count() <= 80));
}

#[test]
fn words_follow_the_numbers() {
    let mut found = findings();
    let verdicts = |found: &Reproduction| {
        let markdown = text(found, "report.md");
        markdown.split_once("## Where the original is as good").unwrap().1.to_owned()
    };
    // Made-up iterations grow by one from formulation to formulation, and shares of starts fall.
    let before = verdicts(&found);
    assert!(before.contains("(`screw`) are as good") && before.contains("these starts show no difference"), "{before}");
    assert!(before.contains("From poses, there are too few trials to decide"), "{before}");
    for row in &mut found.efficiency {
        row.ratio_sigma = 1e-4;
    }
    for run in &mut found.runs {
        run.converged = false;
    }
    let after = verdicts(&found);
    assert!(after.contains("are not as good") && after.contains("does not reach the truth"), "{after}");
    assert!(after.contains("From poses, `screw` is worse") && after.contains("gear factor"), "{after}");
}
