//! Pictures in files: depths, colours, orientation, and what is none.

use std::fs;
use std::path::PathBuf;

use image::{DynamicImage, ImageBuffer, Luma, Rgb};
use poecal_detect::Picture;

fn path(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

#[test]
fn depths_and_colours_become_gray() {
    let deep: ImageBuffer<Luma<u16>, _> =
        ImageBuffer::from_fn(4, 2, |x, y| Luma([(x * 1000 + y) as u16 * 13]));
    let file = path("deep.png");
    DynamicImage::ImageLuma16(deep).save(&file).unwrap();
    let gray = Picture::open(&file).unwrap().gray;
    let expected = 3001.0 * 13.0 * 255.0 / 65535.0;
    println!("{} of {expected}", gray.row(1)[3]);
    // The fraction of a 16-bit level stays, to single precision.
    assert!((f64::from(gray.row(1)[3]) - expected).abs() < 1e-3);
    let colour: ImageBuffer<Rgb<u8>, _> = ImageBuffer::from_pixel(3, 3, Rgb([200, 100, 50]));
    let file = path("colour.png");
    DynamicImage::ImageRgb8(colour).save(&file).unwrap();
    // 0.299 · 200 + 0.587 · 100 + 0.114 · 50 = 124.2, and OpenCV rounds.
    assert_eq!(Picture::open(&file).unwrap().gray.row(0)[0], 124.0);
}

/// A JPEG file with an EXIF orientation.
fn jpeg(orientation: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let picture: ImageBuffer<Luma<u8>, _> =
        ImageBuffer::from_fn(32, 16, |x, y| Luma([if x < 8 && y < 8 { 0 } else { 255 }]));
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100);
    DynamicImage::ImageLuma8(picture).write_with_encoder(encoder).unwrap();
    let mut exif = b"Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
    exif.extend([orientation, 0, 0, 0, 0, 0, 0]);
    let mut whole = bytes[..2].to_vec();
    whole.extend([0xff, 0xe1, 0, exif.len() as u8 + 2]);
    whole.extend(exif);
    whole.extend(&bytes[2..]);
    whole
}

#[test]
fn a_picture_stands_upright() {
    // Width, and where the dark corner is: of each orientation of EXIF.
    for (orientation, width, dark, degrees, mirrored) in [
        (1, 32, (0, 0), 0, false),
        (2, 32, (31, 0), 0, true),
        (3, 32, (31, 15), 180, false),
        (4, 32, (0, 15), 180, true),
        (6, 16, (15, 0), 90, false),
        (8, 16, (0, 31), 270, false),
    ] {
        let file = path(&format!("turned{orientation}.jpg"));
        fs::write(&file, jpeg(orientation)).unwrap();
        let picture = Picture::open(&file).unwrap();
        println!("{orientation}: {}", picture.turned);
        assert_eq!((picture.turned.degrees, picture.turned.mirrored), (degrees, mirrored));
        assert_eq!(picture.turned.is_turned(), orientation != 1);
        assert_eq!(picture.gray.width(), width);
        assert!(picture.gray.row(dark.1)[dark.0] < 60.0, "{orientation}");
    }
}

#[test]
fn what_is_no_picture_is_told_with_its_path() {
    let file = path("none.png");
    fs::write(&file, "id,u,v\n1,2,3\n").unwrap();
    let half = path("half.jpg");
    fs::write(&half, &jpeg(1)[..120]).unwrap();
    for file in [file, half, path("missing.png"), PathBuf::from(env!("CARGO_TARGET_TMPDIR"))] {
        let message = Picture::open(&file).unwrap_err().to_string();
        println!("{message}");
        assert!(message.starts_with(&file.display().to_string()) && !message.contains('\n'));
    }
}
