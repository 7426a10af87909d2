//! The committed header matches the code.

use std::path::Path;

/// Environment variable that requests rewriting the header.
const WRITE: &str = "POECAL_WRITE_HEADER";

#[test]
fn the_header_is_that_of_the_code() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).unwrap();
    let mut made = Vec::new();
    let source = root.join("src/lib.rs");
    cbindgen::Builder::new().with_config(config).with_src(source).generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    let path = root.join("include/poecal.h");
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap();
    assert!(made == committed, "the header is another: `{WRITE}=1 cargo test -p poecal-c` writes it");
}
