//! `poecal detect --print`: pages with boards, and their ruler measurements.

use crate::folder::Folder;

const SPEC: &str = "charuco:5x7:36mm:18mm:DICT_6X6_250";

#[test]
fn a_board_is_drawn_as_pdf_and_svg() {
    let folder = Folder::new();
    let out = folder.run_to_success(&format!("detect --print {SPEC} --paper a4 --out board.pdf"));
    assert!(out.starts_with("written       board.pdf\n"), "{out}");
    for words in ["5 columns by 7 rows of 36 mm squares", "210 x 297 mm", &format!("calibrate     --markers {SPEC}\n")]
    {
        assert!(out.contains(words), "`{words}` is not in\n{out}");
    }
    let pdf = folder.read("board.pdf");
    assert!(pdf.starts_with("%PDF-") && pdf.contains("/MediaBox [0 0 595.27559 841.88976]"));
    assert_eq!(folder.run_to_success(&format!("detect --print {SPEC} --paper letter --out board.SVG --quiet")), "");
    assert!(folder.read("board.SVG").contains("width=\"215.9mm\" height=\"279.4mm\""));
}

#[test]
fn dots_and_tags_are_drawn_and_measured_too() {
    for (spec, words, measured, printed) in [
        (
            "circles:4x11:20mm:asymmetric",
            "Asymmetric circle grid, 4 columns by 11 rows of dots, 20 mm",
            "139.3mm,199mm",
            "circles:4x11:19.9mm:asymmetric",
        ),
        (
            "aprilgrid:6x6:22mm:0.3",
            "AprilGrid, 6 columns by 6 rows of 22 mm tags of DICT_APRILTAG_36h11",
            "164.175mm,164.175mm",
            "aprilgrid:6x6:21.89mm:0.3:DICT_APRILTAG_36h11",
        ),
        (
            "tags:36h11:50mm",
            "Tags of DICT_APRILTAG_36h11, 50 mm from edge to edge of the black border",
            "50.2mm,50.2mm",
            "tags:DICT_APRILTAG_36h11:50.2mm",
        ),
    ] {
        let folder = Folder::new();
        let out =
            folder.run_to_success(&format!("detect --print {spec} --out board.pdf")).replace("\n              ", " ");
        assert!(out.contains(words) && folder.read("board.pdf").starts_with("%PDF-"), "{out}");
        folder.run_to_success(&format!("detect --print {spec} --out board.svg --quiet"));
        assert!(folder.read("board.svg").contains("check the rulers"));
        let run = folder.run(&format!("detect --print {spec} --measured {measured}"));
        assert_eq!((run.code, run.out), (0, format!("--markers {printed}\n")), "{}", run.err);
    }
}

#[test]
fn what_it_prints_is_a_board_of_calibrate() {
    let folder = Folder::new();
    let printed = folder.run(&format!("detect --print {SPEC}:legacy --measured 179.4mm,251.16mm"));
    assert_eq!(
        (printed.code, printed.out.as_str()),
        (0, "--markers charuco:5x7:35.88mm:17.94mm:DICT_6X6_250:legacy\n")
    );
    assert!(
        printed.err.contains("the print is 0.33 % smaller along x, 0.33 % smaller along y")
            && !printed.err.contains("--free board"),
        "{}",
        printed.err
    );
    assert!(folder.listing().is_empty());
    let help = folder.run_to_success("detect --help");
    assert!(help.contains("--measured <X,Y>") && help.is_ascii(), "{help}");
}

#[test]
fn a_print_of_two_scales_is_told_with_what_to_free() {
    let run = Folder::new().run("detect --print chessboard:10x7:27mm --measured 270mm,188mm");
    assert_eq!((run.code, run.out.as_str()), (0, "--markers chessboard:10x7:26.953mm\n"));
    let expected = "along x and y the scales differ by 0.53 %";
    assert!(run.err.contains(expected) && run.err.contains("--free board"), "{}", run.err);
}

#[test]
fn a_file_that_exists_stays_unless_forced() {
    let folder = Folder::new();
    folder.write("board.pdf", "mine");
    let run = folder.run(&format!("detect --print {SPEC} --out board.pdf"));
    assert!(run.code == 2 && run.err.contains("board.pdf"), "{}", run.err);
    assert_eq!(folder.read("board.pdf"), "mine");
    folder.run_to_success(&format!("detect --print {SPEC} --out board.pdf --force"));
    assert!(folder.read("board.pdf").starts_with("%PDF-"));
}

#[test]
fn bad_input_is_one_sentence_and_nothing_is_written() {
    let folder = Folder::new();
    for (arguments, part) in [
        ("detect --print checkers --out board.pdf", "expected chessboard:COLSxROWS:SQUARE"),
        ("detect --print chessboard:10x7:28 --out board.pdf", "with its unit"),
        ("detect --print chessboard:10x7:27mm", "found neither --out nor --measured"),
        (
            "detect --print chessboard:10x7:27mm --out board.png",
            "found no form in the name `board.png`, expected .svg or .pdf",
        ),
        ("detect --print chessboard:10x7:27mm --out -", "expected .svg or .pdf"),
        ("detect --print chessboard:10x7:27mm --paper a9 --out board.pdf", "--paper: found the page \"a9\""),
        ("detect --print chessboard:10x7:27mm --paper 400x300 --out board.pdf", "such as 400x300mm"),
        (
            "detect --print charuco:5x7:60mm:40mm:DICT_6X6_250 --out board.pdf",
            "expected a page of at least 320 x 440 mm, which leaves 10 mm on each side for rulers and words, or squares of at most 38 mm",
        ),
        ("detect --print chessboard:10x7:0.1mm --out board.pdf", "at least 1 mm on paper"),
        ("detect --print circles:9x6:30mm:odd --out board.pdf", "expected asymmetric or nothing"),
        ("detect --print aprilgrid:6x6:88mm:0.3 --out board.pdf", "or tags of at most 23.4 mm"),
        ("detect --print tags:36h11:250mm --out board.pdf", "or tags of at most 190 mm"),
        (
            "detect --print circles:9x6:20mm --measured 200mm,10mm",
            "from the left edge of the leftmost dot to that of the rightmost one",
        ),
        ("detect --print chessboard:10x7:27mm --measured 270mm", "--measured: found \"270mm\""),
        ("detect --print chessboard:10x7:27mm --measured 270mm,0mm", "with their units"),
        (
            "detect --print chessboard:10x7:27mm --measured 27mm,189mm --out board.pdf",
            "found 27 mm along x, expected about 270 mm",
        ),
        ("detect --print chessboard:10x7:27mm --out nowhere/board.pdf", "nowhere"),
    ] {
        let run = folder.run(arguments);
        assert!(run.code == 2 && run.out.is_empty(), "{arguments}: {}{}", run.out, run.err);
        assert!(run.err.starts_with("error: ") && run.err.contains(part), "{arguments}: {}", run.err);
        assert_eq!(run.err.lines().count(), 1, "{arguments}: {}", run.err);
    }
    assert!(folder.listing().is_empty(), "{:?}", folder.listing());
}

#[test]
fn a_chessboard_that_looks_the_same_turned_is_told() {
    for (spec, told) in [
        ("chessboard:9x7:20mm", true),
        ("chessboard:9x6:20mm", false),
        ("charuco:5x7:20mm:15mm:DICT_4X4_50", false),
        ("circles:9x6:20mm", true),
        ("circles:4x10:18mm:asymmetric", true),
        ("circles:4x11:18mm:asymmetric", false),
        ("aprilgrid:6x6:20mm:0.3", false),
        ("tags:36h11:50mm", false),
    ] {
        let run = Folder::new().run(&format!("detect --print {spec} --out board.svg"));
        assert_eq!((run.code, run.err.contains("turned by 180 degrees")), (0, told), "{spec}: {}", run.err);
    }
}
