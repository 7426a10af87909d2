//! Boards on paper: the detector finds the drawn board, and the files contain it.

use poecal_detect::print::{PaperSize, PrintSheet, Rectangle, SheetText};
use poecal_detect::{BoardLayout, BoardSpec, Detector, Gray};

const BOARDS: [&str; 17] = [
    "charuco:5x7:36mm:18mm:DICT_6X6_250",
    "charuco:5x7:36mm:18mm:DICT_6X6_250:legacy",
    "charuco:7x5:36mm:27mm:DICT_4X4_50",
    "charuco:6x8:30mm:22mm:DICT_5X5_100",
    "charuco:6x8:30mm:22mm:DICT_5X5_100:legacy",
    "charuco:8x6:30mm:22mm:DICT_APRILTAG_36h11:legacy",
    "charuco:9x6:30mm:21mm:DICT_7X7_100:legacy",
    "chessboard:10x7:27mm",
    "chessboard:7x10:25mm",
    "chessboard:6x9:30mm",
    "circles:9x6:24mm",
    "circles:5x9:27mm",
    "circles:4x11:20mm:asymmetric",
    "tags:36h11:50mm",
    "tags:DICT_4X4_50:24mm",
    "aprilgrid:6x6:23mm:0.3",
    "aprilgrid:4x7:25mm:0.25:25h9",
];

fn sheet(spec: &str, page: &str) -> PrintSheet {
    PrintSheet::new(&spec.parse().unwrap(), &page.parse().unwrap()).unwrap()
}

/// Area of words: a bar as high as capitals, darker than any print of them.
fn bar(words: &SheetText) -> Rectangle {
    let [x, y] = words.at_mm;
    let (length, high) = (words.length_mm, 0.72 * words.size_mm);
    if words.downwards {
        Rectangle { from_mm: [x, y], to_mm: [x + high, y + length] }
    } else {
        Rectangle { from_mm: [x, y - high], to_mm: [x + length, y] }
    }
}

/// The page as a picture: each pixel as dark as its covered share.
fn picture(sheet: &PrintSheet, px_per_mm: f64) -> Gray {
    let [width, height] = sheet.size_mm.map(|it| (it * px_per_mm).ceil() as usize);
    let mut levels = vec![235.0_f32; width * height];
    for it in sheet.rectangles.iter().copied().chain(sheet.words.iter().map(bar)) {
        let covered = |axis: usize, cell: usize| {
            let from = (it.from_mm[axis] * px_per_mm).max(cell as f64);
            (it.to_mm[axis] * px_per_mm).min(cell as f64 + 1.0) - from
        };
        let cells = |axis: usize, size: usize| {
            let to = (it.to_mm[axis] * px_per_mm).ceil() as usize;
            (it.from_mm[axis] * px_per_mm) as usize..to.min(size)
        };
        for row in cells(1, height) {
            for column in cells(0, width) {
                let part = covered(0, column).max(0.0) * covered(1, row).max(0.0);
                levels[row * width + column] -= 205.0 * part as f32;
            }
        }
    }
    for disc in &sheet.discs {
        // Dark part of the disc, in pixels of 8 × 8 samples.
        let [x, y] = disc.middle_mm.map(|it| it * px_per_mm);
        let radius = disc.radius_mm * px_per_mm;
        for row in (y - radius) as usize..=(y + radius) as usize {
            for column in (x - radius) as usize..=(x + radius) as usize {
                let part = |at: usize| (at as f64 + 0.5) / 8.0;
                let is_in =
                    |at: usize| (column as f64 + part(at % 8) - x).hypot(row as f64 + part(at / 8) - y) < radius;
                levels[row * width + column] -= 205.0 / 64.0 * (0..64).filter(|at| is_in(*at)).count() as f32;
            }
        }
    }
    Gray::new(width, height, levels).unwrap().blur(0.7, 4.0)
}

#[test]
fn the_detector_finds_every_corner_of_what_is_drawn() {
    const PX_PER_MM: f64 = 3.3;
    for text in BOARDS {
        let spec: BoardSpec = text.parse().unwrap();
        let layout = BoardLayout::new(&spec);
        let sheet = sheet(text, "a4");
        let found = Detector::new(&spec).detect(&picture(&sheet, PX_PER_MM)).unwrap();
        // Loose tags are as many as fit on the page.
        let markers = if matches!(spec, BoardSpec::Tags(_)) { sheet.points() / 4 } else { layout.marker_count() };
        assert_eq!((found.corners.len(), found.markers), (sheet.points(), markers), "{text}");
        let mut farthest = 0.0_f64;
        for corner in &found.corners {
            let place = sheet.place_mm(corner.id);
            for (axis, pixel) in [corner.u_px, corner.v_px].into_iter().enumerate() {
                // The centre of the first pixel is zero.
                let drawn = place[axis] * PX_PER_MM - 0.5;
                farthest = farthest.max((pixel - drawn).abs());
            }
        }
        println!("{text}: at most {farthest:.3} px");
        // Lattices of dots look the same turned, but the page is upright.
        let turns = text.starts_with("circles") && !text.ends_with("4x11:20mm:asymmetric");
        let limit = if matches!(spec, BoardSpec::Chessboard(_) | BoardSpec::Charuco(_)) { 0.1 } else { 0.05 };
        assert!(farthest < limit && found.turnable == turns, "{text}: {farthest} px");
    }
}

#[test]
fn the_legacy_pattern_of_even_rows_is_another_board() {
    let spec = "charuco:6x8:30mm:22mm:DICT_5X5_100";
    let drawn = picture(&sheet(&format!("{spec}:legacy"), "a4"), 3.3);
    assert!(Detector::new(&spec.parse().unwrap()).detect(&drawn).is_err());
}

/// True if a rectangle has no point in common with another one.
fn are_apart(one: &Rectangle, other: &Rectangle) -> bool {
    [0, 1]
        .into_iter()
        .any(|axis| one.to_mm[axis] <= other.from_mm[axis] + 1e-9 || other.to_mm[axis] <= one.from_mm[axis] + 1e-9)
}

#[test]
fn rulers_and_words_stand_between_board_and_edge() {
    let pages = ["a4", "a3", "letter", "290x290mm", "3000x2000mm"];
    let tight = [
        ("chessboard:10x7:27.1mm", "a4"),
        ("charuco:3x3:10mm:7mm:DICT_4X4_50", "60x60mm"),
        ("tags:36h11:20mm", "60x60mm"),
        ("tags:36h11:190mm", "a4"),
    ];
    let all = BOARDS.iter().flat_map(|spec| pages.map(|page| (*spec, page))).chain(tight);
    let mut drawn = 0;
    for (spec, page) in all {
        let Ok(sheet) = PrintSheet::new(&spec.parse().unwrap(), &page.parse().unwrap()) else { continue };
        drawn += 1;
        let board = sheet.board;
        let middle = [0, 1].map(|axis| (board.from_mm[axis] + board.to_mm[axis]) - sheet.size_mm[axis]);
        assert!(middle.iter().all(|it| it.abs() < 1e-9), "{spec} on {page}");
        let inside = |it: &Rectangle| {
            (0..2).all(|axis| {
                it.from_mm[axis] >= board.from_mm[axis] - 1e-9 && it.to_mm[axis] <= board.to_mm[axis] + 1e-9
            })
        };
        let lines = sheet.rectangles.iter().copied().filter(|it| !inside(it));
        let bars: Vec<Rectangle> = sheet.words.iter().map(bar).collect();
        let (names, bars): (Vec<Rectangle>, Vec<Rectangle>) = bars.into_iter().partition(inside);
        // Names of loose tags are between them.
        assert!(names.is_empty() || spec.starts_with("tags"), "{spec} on {page}: words on the board");
        assert!(names.iter().all(|name| sheet.rectangles.iter().all(|it| are_apart(name, it))), "{spec} on {page}");
        for it in lines.chain(bars.iter().copied()) {
            assert!(are_apart(&it, &board), "{spec} on {page}: {it:?} is on the board");
            let within = (0..2).all(|axis| it.from_mm[axis] >= 3.5 && it.to_mm[axis] <= sheet.size_mm[axis] - 4.5);
            assert!(within, "{spec} on {page}: {it:?} is at the edge");
        }
        let bars: Vec<Rectangle> = bars.into_iter().chain(names).collect();
        for (at, one) in bars.iter().enumerate() {
            assert!(bars[..at].iter().all(|other| are_apart(one, other)), "{spec} on {page}: words overlap");
        }
        let text: String = sheet.words.iter().map(|it| format!("{} ", it.text)).collect();
        assert!(text.is_ascii());
        let stated: BoardSpec = spec.parse().unwrap();
        assert!(text.contains(&format!("--markers {stated}")), "{spec} on {page}: {text}");
        assert!(text.contains("100 mm") || page == "60x60mm", "{spec} on {page}");
    }
    assert!(drawn > 30, "{drawn}");
}

#[test]
fn a_large_page_has_a_square_of_white_around_the_board() {
    let sheet = sheet("chessboard:10x7:27mm", "a3");
    let board =
        Rectangle { from_mm: sheet.board.from_mm.map(|it| it - 26.9), to_mm: sheet.board.to_mm.map(|it| it + 26.9) };
    assert!(sheet.words.iter().all(|it| are_apart(&bar(it), &board)));
}

#[test]
fn a_named_page_lies_as_the_board_does() {
    assert_eq!(sheet("chessboard:10x7:27mm", "a4").size_mm, [297.0, 210.0]);
    assert_eq!(sheet("chessboard:7x10:27mm", "a4").size_mm, [210.0, 297.0]);
    assert_eq!(sheet("chessboard:10x7:27mm", "300x400mm").size_mm, [300.0, 400.0]);
}

#[test]
fn a_board_too_large_for_the_page_is_told_with_what_would_do() {
    let refused = |spec: &str, page: &str| {
        PrintSheet::new(&spec.parse().unwrap(), &page.parse::<PaperSize>().unwrap()).unwrap_err().to_string()
    };
    assert_eq!(
        refused("charuco:5x7:60mm:40mm:DICT_6X6_250", "a4"),
        "found a board of 300 x 420 mm on a page of 210 x 297 mm, expected a page of at least 320 x 440 mm, which leaves 10 mm on each side \
         for rulers and words, or squares of at most 38 mm"
    );
    let message = refused("chessboard:10x7:28mm", "a4");
    assert!(
        message.contains("at least 300 x 216 mm") && message.ends_with("or squares of at most 27.1 mm"),
        "{message}"
    );
    // The recommended sizes fit.
    sheet("chessboard:10x7:27.1mm", "a4");
    sheet("charuco:5x7:60mm:40mm:DICT_6X6_250", "320x440mm");
    assert!(refused("chessboard:250x250:28mm", "50x50mm").ends_with("for rulers and words"));
    assert!(refused("chessboard:5x7:0.5mm", "a4").contains("at least 1 mm on paper"));
}

#[test]
fn the_svg_has_the_rectangles_and_words_in_millimetres() {
    let sheet = sheet("charuco:5x7:36mm:18mm:DICT_6X6_250", "letter");
    let text = sheet.svg();
    let svg = roxmltree::Document::parse(&text).unwrap();
    let root = svg.root_element();
    assert_eq!(root.attribute("width"), Some("215.9mm"));
    assert_eq!(root.attribute("viewBox"), Some("0 0 215.9 279.4"));
    let named =
        |name: &'static str| svg.descendants().filter(move |it| it.has_tag_name(("http://www.w3.org/2000/svg", name)));
    let path = named("path").next().unwrap().attribute("d").unwrap();
    let parts: Vec<&str> = path.split_terminator('Z').filter(|it| !it.trim().is_empty()).collect();
    assert_eq!(parts.len(), sheet.rectangles.len());
    for (line, it) in parts.into_iter().zip(&sheet.rectangles) {
        let numbers: Vec<f64> = line.split(['M', ' ', 'H', 'V']).filter_map(|it| it.parse().ok()).collect();
        let expected = [it.from_mm[0], it.from_mm[1], it.to_mm[0], it.to_mm[1], it.from_mm[0]];
        assert!(
            numbers.len() == 5 && numbers.iter().zip(expected).all(|(one, other)| (one - other).abs() < 6e-5),
            "{line}"
        );
    }
    let words: Vec<&str> = named("text").filter_map(|it| it.text()).collect();
    assert_eq!(words, sheet.words.iter().map(|it| it.text.as_str()).collect::<Vec<_>>());
}

/// The bytes of an object of a PDF, at the offset in its table of objects.
fn object(pdf: &str, number: usize) -> &str {
    let table: usize = pdf.rsplit("startxref\n").next().unwrap().lines().next().unwrap().parse().unwrap();
    let mut lines = pdf[table..].split_inclusive('\n');
    assert_eq!(lines.next(), Some("xref\n"));
    let count: usize = lines.next().unwrap().trim().strip_prefix("0 ").unwrap().parse().unwrap();
    let entries: Vec<&str> = lines.take(count).collect();
    assert!(number < count && entries.iter().all(|it| it.len() == 20), "{entries:?}");
    assert!(pdf.contains(&format!("/Size {count}")));
    let place: usize = entries[number][..10].parse().unwrap();
    let object = &pdf[place..];
    assert!(object.starts_with(&format!("{number} 0 obj\n")), "object {number} is not at {place}");
    &object[..object.find("endobj").unwrap()]
}

#[test]
fn dots_are_discs_in_both_files() {
    let sheet = sheet("circles:9x6:24mm", "a4");
    assert_eq!((sheet.discs.len(), sheet.points()), (54, 54));
    let first = sheet.discs[0];
    // A pitch from the edge of the board, and half of it wide.
    assert!((first.middle_mm[0] - sheet.board.from_mm[0] - 24.0).abs() < 1e-9 && first.radius_mm == 6.0);
    assert_eq!(sheet.place_mm(0), first.middle_mm);
    let svg = sheet.svg();
    let arcs: Vec<&str> = svg.lines().filter(|line| line.contains("a6 6 0 0 1 12 0a6 6 0 0 1 -12 0Z")).collect();
    assert!(arcs.len() == 54 && arcs[0].starts_with(&format!("M{} ", first.middle_mm[0] - 6.0)), "{arcs:?}");
    let pdf = sheet.pdf();
    let curves: Vec<Vec<f64>> = pdf
        .lines()
        .filter_map(|line| line.strip_suffix(" c"))
        .map(|line| line.split(' ').map(|it| it.parse().unwrap()).collect())
        .collect();
    assert_eq!(curves.len(), 4 * 54);
    // Halfway along the first quarter, which begins to the right of the middle.
    let [x, y] = first.middle_mm;
    let half = [(x + 6.0, 0), (y, 1)]
        .map(|(begin, axis)| (begin + 3.0 * curves[0][axis] + 3.0 * curves[0][2 + axis] + curves[0][4 + axis]) / 8.0);
    assert!(((half[0] - x).hypot(half[1] - y) - 6.0).abs() < 0.002, "{half:?}");
}

#[test]
fn a_page_of_tags_has_as_many_as_fit() {
    let a4 = sheet("tags:36h11:50mm", "a4");
    let names: Vec<&str> = a4.words.iter().map(|it| it.text.as_str()).filter(|it| it.starts_with("tag")).collect();
    // Pitches of 70 mm: two and a tag beside each other, three below.
    assert_eq!((a4.points(), names.len(), names[0], names[8]), (4 * 9, 9, "tag0", "tag8"));
    // No more than exist.
    assert_eq!(sheet("tags:16h5:20mm", "3000x2000mm").points(), 4 * 30);
    let refused = PrintSheet::new(&"tags:36h11:250mm".parse().unwrap(), &"a4".parse().unwrap()).unwrap_err();
    assert!(
        refused.to_string().contains("at least 270 x 370 mm")
            && refused.to_string().ends_with("tags of at most 190 mm"),
        "{refused}"
    );
}

#[test]
fn the_pdf_reads_back_as_it_was_drawn() {
    let sheet = sheet("charuco:6x8:30mm:22mm:DICT_5X5_100:legacy", "a4");
    let pdf = sheet.pdf();
    assert!(pdf.is_ascii() && pdf.starts_with("%PDF-1.") && pdf.ends_with("%%EOF\n"));
    assert!(object(&pdf, 1).contains("/PrintScaling /None"));
    let boxed = object(&pdf, 3).split("/MediaBox [0 0 ").nth(1).unwrap().split(']').next().unwrap();
    let points: Vec<f64> = boxed.split(' ').map(|it| it.parse().unwrap()).collect();
    assert!((points[0] - 210.0 / 25.4 * 72.0).abs() < 1e-4 && (points[1] - 297.0 / 25.4 * 72.0).abs() < 1e-4);
    let content = object(&pdf, 4);
    let length: usize = content.split("/Length ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let stream = content.split_once("stream\n").unwrap().1;
    assert!(stream[length..].trim() == "endstream");
    let rectangles: Vec<Vec<f64>> = stream
        .lines()
        .filter_map(|line| line.strip_suffix(" re"))
        .map(|line| line.split(' ').map(|it| it.parse().unwrap()).collect())
        .collect();
    assert_eq!(rectangles.len(), sheet.rectangles.len());
    for (read, it) in rectangles.iter().zip(&sheet.rectangles) {
        let ends = [read[0] + read[2], read[1] + read[3]];
        assert!(
            (0..2)
                .all(|axis| (read[axis] - it.from_mm[axis]).abs() < 1e-5 && (ends[axis] - it.to_mm[axis]).abs() < 2e-5)
        );
    }
    assert_eq!(stream.matches(") Tj").count(), sheet.words.len());
    assert!(stream.contains("Print at 100 % \\(actual size\\)"));
    for number in [2, 5, 6] {
        object(&pdf, number);
    }
}
