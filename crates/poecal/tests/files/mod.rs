//! A folder for a test's files, and a robot to read them for.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Vector3;
use poecal::lie::{Pose, Screw};
use poecal::robot::{Joint, Limits, Robot};

/// A new folder that goes with its owner.
pub(crate) struct Folder(PathBuf);

static COUNT: AtomicUsize = AtomicUsize::new(0);

impl Folder {
    pub(crate) fn new() -> Self {
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("poecal_files_{}_{number}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, content).unwrap();
        path
    }

    /// A message as if the folder were the current one.
    pub(crate) fn without_path(&self, message: &str) -> String {
        message.replace(&format!("{}/", self.0.display()), "")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// `a` turns by half a turn either way, `lift` slides up to 0.5 m, `b` turns without limits; the tip is 1 m out.
pub(crate) fn robot() -> Robot {
    let z = Vector3::z();
    let a = Joint::revolute("a", Screw::revolute(&z, &Vector3::zeros()));
    let lift = Joint::prismatic("lift", Screw::prismatic(&z));
    let b = Joint::revolute("b", Screw::revolute(&z, &Vector3::new(0.5, 0.0, 0.0)));
    let joints = vec![
        Joint { limits: Some(Limits { lower: -3.15, upper: 3.15 }), ..a },
        Joint { limits: Some(Limits { lower: 0.0, upper: 0.5 }), ..lift },
        b,
    ];
    Robot::new("test", joints, Pose::from_translation(Vector3::new(1.0, 0.0, 0.3))).unwrap()
}
