//! Pictures in files: depths, colours, orientation, and files that are none.

use std::borrow::Cow;
use std::fs;
use std::path::PathBuf;

use png::{BitDepth, ColorType, Encoder};
use poecal_detect::GrayPicture;

fn path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

/// A PNG file with these samples; `more` sets its other properties.
fn png(
    [width, height]: [u32; 2],
    (colours, depth): (ColorType, BitDepth),
    samples: &[u8],
    more: impl FnOnce(&mut Encoder<'_, &mut Vec<u8>>),
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(colours);
    encoder.set_depth(depth);
    more(&mut encoder);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(samples).unwrap();
    writer.finish().unwrap();
    bytes
}

fn levels(bytes: &[u8]) -> Vec<f32> {
    GrayPicture::decode(bytes, &path("given")).unwrap().gray.levels().to_vec()
}

#[test]
fn depths_and_colours_become_gray() {
    let deep: Vec<u16> = (0..2).flat_map(|y| (0..4).map(move |x| (x * 1000 + y) * 13)).collect();
    let samples: Vec<u8> = deep.iter().flat_map(|it| it.to_be_bytes()).collect();
    let file = path("deep.png");
    fs::write(&file, png([4, 2], (ColorType::Grayscale, BitDepth::Sixteen), &samples, |_| ())).unwrap();
    let gray = GrayPicture::open(&file).unwrap().gray;
    let expected = 3001.0 * 13.0 * 255.0 / 65535.0;
    println!("{} of {expected}", gray.row(1)[3]);
    // The fraction of a 16-bit level stays, to single precision.
    assert!((f64::from(gray.row(1)[3]) - expected).abs() < 1e-3);
    let file = path("colour.png");
    let samples = [200, 100, 50].repeat(9);
    fs::write(&file, png([3, 3], (ColorType::Rgb, BitDepth::Eight), &samples, |_| ())).unwrap();
    // 0.299 · 200 + 0.587 · 100 + 0.114 · 50 = 124.2, and OpenCV rounds.
    assert_eq!(GrayPicture::open(&file).unwrap().gray.row(0)[0], 124.0);
}

#[test]
fn every_form_of_png_is_read() {
    let read = |form, samples: &[u8]| levels(&png([2, 1], form, samples, |_| ()));
    for (depth, samples, expected) in [
        (BitDepth::One, [0b0100_0000].as_slice(), [0.0, 255.0]),
        (BitDepth::Two, &[0b0110_0000], [85.0, 170.0]),
        (BitDepth::Four, &[0x1e], [17.0, 238.0]),
        (BitDepth::Eight, &[3, 250], [3.0, 250.0]),
        (BitDepth::Sixteen, &[0, 0, 0xff, 0xff], [0.0, 255.0]),
    ] {
        assert_eq!(read((ColorType::Grayscale, depth), samples), expected);
    }
    // Opacity is ignored.
    assert_eq!(read((ColorType::GrayscaleAlpha, BitDepth::Eight), &[3, 0, 250, 9]), [3.0, 250.0]);
    assert_eq!(read((ColorType::Rgba, BitDepth::Eight), &[200, 100, 50, 0, 0, 0, 255, 7]), [124.0, 29.0]);
    let deep = |samples: &[u16]| samples.iter().flat_map(|it| it.to_be_bytes()).collect::<Vec<u8>>();
    let gray = read((ColorType::GrayscaleAlpha, BitDepth::Sixteen), &deep(&[30_000, 0, 1, 9]));
    let expected = [30_000_u16, 1].map(|it| {
        let it = f32::from(it);
        (0.299 * it + 0.587 * it + 0.114 * it) * (255.0 / 65535.0)
    });
    assert_eq!(gray, expected);
    let colours = [20_000, 10_000, 5_000, 0, 0, 65_535];
    let expected = [(0.299 * 20_000.0_f32 + 0.587 * 10_000.0 + 0.114 * 5_000.0), 0.114 * 65_535.0]
        .map(|it| it * (255.0 / 65535.0));
    assert_eq!(read((ColorType::Rgb, BitDepth::Sixteen), &deep(&colours)), expected);
    let with_alpha = [20_000, 10_000, 5_000, 0, 0, 0, 65_535, 3];
    assert_eq!(read((ColorType::Rgba, BitDepth::Sixteen), &deep(&with_alpha)), expected);
}

#[test]
fn palettes_and_interlaced_pictures_are_read() {
    const PALETTE: &[u8] = &[200, 100, 50, 0, 0, 255, 9, 9, 9];
    for transparent in [false, true] {
        let read = |depth, samples: &[u8]| {
            levels(&png([3, 1], (ColorType::Indexed, depth), samples, |encoder| {
                encoder.set_palette(PALETTE);
                if transparent {
                    encoder.set_trns(&[0, 128][..]);
                }
            }))
        };
        assert_eq!(read(BitDepth::Eight, &[0, 2, 1]), [124.0, 9.0, 29.0]);
        assert_eq!(read(BitDepth::Two, &[0b0010_0100]), [124.0, 9.0, 29.0]);
    }
    // The writer does not interlace: 5 × 3 levels from 0 to 14.
    let expected: Vec<f32> = (0_u8..15).map(f32::from).collect();
    assert_eq!(levels(include_bytes!("pictures/interlaced.png")), expected);
}

#[test]
fn every_form_of_jpeg_is_read() {
    // Files with the same colours: red and green rise, and blue falls along a row.
    for (bytes, expected) in [
        (include_bytes!("pictures/colour.jpg").as_slice(), [29.0, 121.0, 127.0, 193.0]),
        (include_bytes!("pictures/progressive.jpg"), [29.0, 121.0, 127.0, 193.0]),
        (include_bytes!("pictures/cmyk.jpg"), [28.0, 121.0, 126.0, 193.0]),
        (include_bytes!("pictures/ycck.jpg"), [205.0, 66.0, 198.0, 135.0]),
    ] {
        let gray = GrayPicture::decode(bytes, &path("given")).unwrap().gray;
        assert_eq!((gray.width(), gray.height()), (32, 16));
        assert_eq!([(0, 0), (5, 31), (10, 3), (15, 16)].map(|(row, column)| gray.row(row)[column]), expected);
    }
}

/// EXIF data with an orientation.
fn exif(orientation: u8) -> Vec<u8> {
    let mut exif = b"MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
    exif.extend([orientation, 0, 0, 0, 0, 0, 0]);
    exif
}

/// A JPEG file with an EXIF orientation; the corner of the picture is dark.
fn jpeg(orientation: u8) -> Vec<u8> {
    let bytes = include_bytes!("pictures/gray.jpg");
    let exif = [&b"Exif\0\0"[..], &exif(orientation)].concat();
    let mut whole = bytes[..2].to_vec();
    whole.extend([0xff, 0xe1, 0, exif.len() as u8 + 2]);
    whole.extend(exif);
    whole.extend(&bytes[2..]);
    whole
}

#[test]
fn a_picture_stands_upright() {
    // Width, and position of the dark corner, for each orientation of EXIF.
    for (orientation, width, dark, degrees, mirrored) in [
        (1, 32, (0, 0), 0, false),
        (2, 32, (31, 0), 0, true),
        (3, 32, (31, 15), 180, false),
        (4, 32, (0, 15), 180, true),
        (5, 16, (0, 0), 270, true),
        (6, 16, (15, 0), 90, false),
        (7, 16, (15, 31), 90, true),
        (8, 16, (0, 31), 270, false),
    ] {
        let file = path(&format!("turned{orientation}.jpg"));
        fs::write(&file, jpeg(orientation)).unwrap();
        let picture = GrayPicture::open(&file).unwrap();
        println!("{orientation}: {}", picture.turned);
        assert_eq!((picture.turned.degrees, picture.turned.mirrored), (degrees, mirrored));
        assert_eq!(picture.turned.is_turned(), orientation != 1);
        assert_eq!(picture.gray.width(), width);
        assert!(picture.gray.row(dark.1)[dark.0] < 60.0, "{orientation}");
    }
}

#[test]
fn a_png_stands_upright() {
    for (orientation, expected) in [
        (1, [0, 1, 2, 3, 4, 5]),
        (2, [2, 1, 0, 5, 4, 3]),
        (3, [5, 4, 3, 2, 1, 0]),
        (4, [3, 4, 5, 0, 1, 2]),
        (5, [0, 3, 1, 4, 2, 5]),
        (6, [3, 0, 4, 1, 5, 2]),
        (7, [5, 2, 4, 1, 3, 0]),
        (8, [2, 5, 1, 4, 0, 3]),
    ] {
        let mut info = png::Info::with_size(3, 2);
        info.exif_metadata = Some(Cow::Owned(exif(orientation)));
        let mut bytes = Vec::new();
        let mut writer = Encoder::with_info(&mut bytes, info).unwrap().write_header().unwrap();
        writer.write_image_data(&[0, 1, 2, 3, 4, 5]).unwrap();
        writer.finish().unwrap();
        let picture = GrayPicture::decode(&bytes, &path("given")).unwrap();
        assert_eq!(picture.gray.levels(), expected.map(|it: u8| f32::from(it)), "{orientation}");
        assert_eq!(picture.gray.width(), if orientation < 5 { 3 } else { 2 });
    }
}

#[test]
fn a_head_that_lies_takes_no_memory() {
    let mut lying = png([1, 1], (ColorType::Rgba, BitDepth::Sixteen), &[0; 8], |_| ());
    // Width and height, and the checksum of the header: of 100 000 × 100 000 pixels.
    lying[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    lying[29..33].copy_from_slice(&[0xf8, 0xc2, 0xd7, 0x8b]);
    let mut jpeg = jpeg(1);
    let at = jpeg.windows(2).position(|it| it == [0xff, 0xc0]).unwrap();
    jpeg[at + 5..at + 9].fill(0xff);
    for bytes in [lying, jpeg] {
        let message = GrayPicture::decode(&bytes, &path("given")).unwrap_err().to_string();
        assert!(message.contains(" pixels, expected at most 50000000 in all"), "{message}");
    }
}

#[test]
fn what_is_no_picture_is_told_with_its_path() {
    let file = path("none.png");
    fs::write(&file, "id,u,v\n1,2,3\n").unwrap();
    let half = path("half.jpg");
    fs::write(&half, &jpeg(1)[..120]).unwrap();
    for file in [file, half, path("missing.png"), PathBuf::from(env!("CARGO_TARGET_TMPDIR"))] {
        let message = GrayPicture::open(&file).unwrap_err().to_string();
        println!("{message}");
        assert!(message.starts_with(&file.display().to_string()) && !message.contains('\n'));
    }
}
