"""The program that the tests run, and tables as it reads and writes them."""

import os
import subprocess
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
URDFS = ROOT / "crates/poecal-testing/data/urdf"
ELBOW = ROOT / "examples/elbow/robot.urdf"


def program() -> str:
    """The program under test."""
    return os.environ.get("POECAL_PROGRAM", str(ROOT / "target/release/poecal"))


def poecal(*arguments) -> str:
    """Standard output of a run that must succeed."""
    run = subprocess.run([program(), *map(str, arguments)], capture_output=True, text=True)
    assert run.returncode == 0, f"poecal {arguments}\n{run.stdout}{run.stderr}"
    return run.stdout


def write_table(path, columns: dict) -> None:
    """A CSV whose numbers read back exactly."""
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns)] + [",".join(repr(float(cell)) for cell in row) for row in rows]
    Path(path).write_text("\n".join(lines) + "\n")


def predict(*arguments) -> np.ndarray:
    """Predicted poses, one row each: x, y, z, qx, qy, qz, qw."""
    header, *rows = poecal("predict", *arguments).splitlines()
    assert header == "x[m],y[m],z[m],qx,qy,qz,qw"
    return np.array([[float(cell) for cell in row.split(",")] for row in rows])


def simulated_session(folder: Path, joints: dict) -> tuple[Path, Path]:
    """A file of exact poses of the elbow with deviating axes, in another device frame, and the actual model."""
    actual = folder / "actual.urdf"
    text = ELBOW.read_text()
    for old, new in [
        ('xyz="0.15 0 0" rpy="0 0 0"', 'xyz="0.152 0.001 0.003" rpy="0.004 0.002 -0.003"'),
        ('xyz="0 0 0.57" rpy="0 0 0"', 'xyz="0 0.001 0.572" rpy="0.01 0.02 0"'),
        ('xyz="0.634 0 0" rpy="0 0 0"', 'xyz="0.633 0.001 0" rpy="0.005 0.01 0.004"'),
    ]:
        assert old in text
        text = text.replace(old, new)
    actual.write_text(text)
    table = folder / "joints.csv"
    write_table(table, joints)
    x, y, z, qx, qy, qz, qw = predict(actual, table).T
    # The device is turned by a quarter about z and shifted: (x, y) becomes (-y, x).
    half = np.sqrt(0.5)
    measured = {"x": -y + 1.5, "y": x - 0.7, "z": z + 0.2}
    turned = {"qx": half * (qx - qy), "qy": half * (qy + qx), "qz": half * (qz + qw), "qw": half * (qw - qz)}
    measurements = folder / "measurements.csv"
    write_table(measurements, {**joints, **measured, **turned})
    return measurements, actual
