"""Real sessions, and poecal run on them: what the commands beside this file share."""
import csv
import json
import os
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SKIPPED = 77
# Name, model, measurements, and options of every public session that moves the joints freely.
SESSIONS = {
    "UR10 A": ("ur10_tmac/robot.urdf", "ur10_tmac/series_A.csv", []),
    "UR10 C": ("ur10_tmac/robot.urdf", "ur10_tmac/series_C.csv", []),
    "MA1400": ("motoman/robot_left_leica.urdf", "motoman/points_left_small.csv", []),
    "Meca500": ("meca500/robot.urdf", "meca500/large160.csv", []),
    "positioner": ("positioner_2axis/robot.urdf", "positioner_2axis/poses.csv", []),
    "IRB 120": ("irb120_faro/robot.urdf", "irb120_faro/points.csv", []),
    "column, flat": ("hilti_column_arm/trailblazer.urdf", "hilti_column_arm/flat.csv", ["--tip-link", "prism"]),
    "column, pallet": ("hilti_column_arm/trailblazer.urdf", "hilti_column_arm/pallet.csv", ["--tip-link", "prism"]),
    "TIAGo": ("tiago_qualisys/robot.urdf", "tiago_qualisys/session_2021-11-30.csv", ["--tip-link", "arm_7_link"]),
    "TIAGo, earlier": ("tiago_qualisys/robot.urdf", "tiago_qualisys/session_2021-11-26.csv", ["--tip-link", "arm_7_link"]),
}


def program():
    given = os.environ.get("POECAL_PROGRAM")
    if given:
        return given
    subprocess.run(["cargo", "build", "--locked", "--release", "-q", "-p", "poecal-cli"], cwd=ROOT, check=True)
    return str(Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "poecal")


def write(path, configurations):
    rows = [row for configuration in configurations for row in configuration]
    keys = [key for key in rows[0] if key not in ("set", "temperature[degC]")]
    with open(path, "w", newline="") as file:
        table = csv.DictWriter(file, keys, extrasaction="ignore")
        table.writeheader()
        table.writerows(rows)


def read(path):
    """The configurations of a file, in its order."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    readings = [key for key in rows[0] if key.split("[")[0] not in ("id", "set", "target", "x", "y", "z", "qx", "qy", "qz", "qw", "temperature", "session")]
    names = {row["id"] for row in rows} if "id" in rows[0] else set()
    key = (lambda row: row["id"]) if len(names) > 3 else (lambda row: tuple(row[name] for name in readings))
    found = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return list(found.values())


class Runs:
    def __init__(self, datasets, folder):
        self.poecal, self.datasets, self.folder = program(), datasets, folder

    def run(self, *words):
        return subprocess.run([self.poecal, *map(str, words)], capture_output=True, text=True)

    def calibrated(self, model, rows, *options):
        """The calibration, or none where it is refused."""
        write(self.folder / "fit.csv", rows)
        out = self.folder / "out"
        done = self.run("calibrate", model, self.folder / "fit.csv", *options, "--out", out, "--force", "--quiet", "--report", "none")
        return json.loads((out / "calibration.json").read_text()) if done.returncode in (0, 1) else None

    def judged(self, rows):
        write(self.folder / "judge.csv", rows)
        words = ["--refit", "device,tool", "--json", "--quiet", "--history", "none"]
        found = json.loads(self.run("validate", self.folder / "out/calibration.json", self.folder / "judge.csv", *words).stdout)
        return found["verdict"]["position_mm"]["rms"]


def add_datasets(parser):
    """The option --datasets."""
    parser.add_argument("--datasets", type=Path, default=Path(os.environ.get("POECAL_DATASETS", ROOT.parent / "shared/datasets")))


@contextmanager
def runs(datasets):
    """Runs of the program in a folder of their own; ends with 77 where the data are not there."""
    if not datasets.is_dir():
        print(f"{datasets}: found no such folder, expected the data: set POECAL_DATASETS, or write --datasets")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as folder:
        yield Runs(datasets, Path(folder))


def end(failed):
    """Prints what failed, and ends with 1 if something did."""
    for sentence in failed:
        print(f"FAILED {sentence}")
    sys.exit(1 if failed else 0)
