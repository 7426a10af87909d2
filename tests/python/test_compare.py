"""`poecal compare` on sessions of the example's elbow: halves of its points, a joint with other readings, another robot."""

import json
import math
import subprocess

import pytest
from program import ELBOW, poecal, program

TURN_DEG = 0.2


@pytest.fixture(scope="module")
def sessions(tmp_path_factory):
    """Calibrations of two halves of the points, and of the second half with joint 3 read 0.2 degrees less."""
    folder = tmp_path_factory.mktemp("compare")
    lines = [line for line in (ELBOW.parent / "points.csv").read_text().splitlines() if line and not line.startswith("#")]
    head, rows = lines[0], lines[1:]
    column = next(k for k, name in enumerate(head.split(",")) if name.startswith("joint3"))
    factor = 1.0 if "deg" in head.split(",")[column] else math.pi / 180

    def moved(row):
        cells = row.split(",")
        cells[column] = repr(float(cells[column]) - TURN_DEG * factor)
        return ",".join(cells)

    def calibrated(name, rows):
        (folder / f"{name}.csv").write_text("\n".join([head, *rows]) + "\n")
        words = ["calibrate", ELBOW, folder / f"{name}.csv", "--out", folder / name, "--report", "none", "--corrections", "off"]
        run = subprocess.run([program(), *map(str, words)], capture_output=True, text=True)
        assert run.returncode in (0, 1), run.stderr
        return folder / name / "calibration.json"

    odd, even = rows[::2], rows[1::2]
    return [calibrated("first", odd), calibrated("second", even), calibrated("moved", [moved(row) for row in even])]


def compared(*words):
    run = subprocess.run([program(), "compare", *map(str, words)], capture_output=True, text=True)
    return run.returncode, run.stdout, run.stderr


def test_one_robot_is_told_as_such(sessions):
    first, second, _ = sessions
    code, text, _ = compared(first, second)
    print(text)
    assert code == 0 and text.startswith("verdict       still good: the tip moved by 0.")
    assert "no change beyond noise" in poecal("compare", first, second, "--verbose") and "χ²" not in text
    found = json.loads(poecal("compare", first, second, "--json"))
    assert found["moved"] is False and found["tip"]["rms_mm"] < found["tip"]["limit_mm"]
    # A limit that is stated decides.
    code, text, _ = compared(first, second, "--limit", "0.01mm")
    assert code == 1 and text.startswith("verdict       no longer good") and "(limit 0.0100 mm)" in text
    assert found["changed"] is False and found["test"]["chi_square"] < found["test"]["limit"]
    assert [joint["name"] for joint in found["joints"]] == [f"joint{k}" for k in range(1, 7)]
    corrections = json.loads(first.read_text())["corrections"]
    assert [joint["first"] for joint in found["joints"]] == [it["change"] for it in corrections]


def test_a_joint_that_is_read_otherwise_is_named(sessions):
    first, second, moved = sessions
    code, text, _ = compared(second, moved, "--json")
    found = json.loads(text)
    offset = found["joints"][2]["change"]["offset_deg"]
    print(f"joint 3 read {TURN_DEG} deg less: offset {offset:.4f} deg, changed {found['changed_joints']}")
    # Its own rows, so that the noise is the same; the tolerance of the fit decides the rest.
    assert code == 1 and "joint3" in found["changed_joints"] and abs(offset - TURN_DEG) < 0.05


def test_what_is_no_pair_is_refused(sessions, tmp_path):
    first, _, _ = sessions
    other = json.loads(first.read_text())
    other["joints"][3]["name"] = "wrist"
    (tmp_path / "other.json").write_text(json.dumps(other))
    code, text, error = compared(first, tmp_path / "other.json")
    print(error)
    assert code == 2 and not text and "`wrist`" in error and "`joint4`" in error
    code, _, error = compared(first, ELBOW)
    assert code == 2 and "calibration.json" in error
