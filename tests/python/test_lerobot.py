"""Arms of LeRobot: its files of motors and its readings, the script that records a session, and the file that goes back."""

import csv
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy
import poecal
import pytest
from program import ROOT, program

SO101 = ROOT / "examples/so101"
CAMERA = ["--camera", SO101 / "camera.csv", "--markers", "charuco:7x5:36mm:26mm:DICT_4X4_50"]
# Zeros (deg) and signs with which the example was made (examples/so101/README.md).
ZEROS = {"shoulder_lift": 14.0, "elbow_flex": -18.0, "wrist_flex": 9.0}
TURNED = {"elbow_flex", "wrist_roll"}
# Middle of a range in ticks, and ticks of a degree.
TICK = 4096 / 360
MOTORS = json.loads((SO101 / "follower.json").read_text())


def run(*words, cwd, code=0):
    done = subprocess.run([program(), *map(str, words)], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("so101")
    words = run("calibrate", SO101 / "robot.urdf", SO101 / "motors.csv", SO101 / "corners.csv", "--columns", SO101 / "follower.json", *CAMERA, "--out", "so101", "--report", "none", cwd=folder)
    return folder, words


def rows():
    return list(csv.DictReader((SO101 / "motors.csv").open()))


def test_signs_and_zeros_are_found_and_stated(calibrated):
    _, words = calibrated
    note = " ".join(re.search(r"motors: (.*?), without", words, re.S)[1].split())
    assert "elbow_flex" in note and "wrist_roll" in note and "count the other way" in note
    for joint, zero in ZEROS.items():
        found = float(re.search(rf"{joint}`? ([+-][0-9.]+) deg", note)[1])
        # The nominal axes are off by 1 degree.
        assert abs(found - zero) < 1.5, (joint, found)


def test_the_file_goes_back_with_the_travel_within_that_before(calibrated):
    folder, _ = calibrated
    words = run("export", "so101/calibration.json", "--format", "lerobot", "--motors", SO101 / "follower.json", "--out", "back.json", "--force", cwd=folder)
    back = json.loads((folder / "back.json").read_text())
    assert "reverse the axis of elbow_flex, wrist_roll" in " ".join(words.split())
    for name, motor in back.items():
        before = MOTORS[name]
        if name == "gripper":
            assert motor == before
            continue
        moved = motor["homing_offset"] - before["homing_offset"]
        # Raw positions of the ends of the travel.
        ends = [[file["homing_offset"] + file[end] for end in ("range_min", "range_max")] for file in (before, motor)]
        assert ends[0][0] <= ends[1][0] < ends[1][1] <= ends[0][1], name
        if name in ZEROS:
            sign = -1 if name in TURNED else 1
            # joint = sign * (ticks - middle) + zero: the joint's zero is at middle - sign * zero.
            assert abs(moved + sign * ZEROS[name] * TICK) < 1.5 * TICK, (name, moved)


def lerobot_degrees(motor, raw):
    """Degrees of a raw position (before the homing offset), by the formula of lerobot 0.6.1 but for its divisor of 4095 instead of 4096."""
    middle = (motor["range_min"] + motor["range_max"]) / 2
    return (raw - motor["homing_offset"] - middle) * 360 / 4096


def test_joint_values_by_the_file_put_the_tip_where_poecal_has_it(calibrated):
    folder, _ = calibrated
    run("export", "so101/calibration.json", "--format", "lerobot", "--motors", SO101 / "follower.json", "--out", "tip.json", "--force", "--quiet", cwd=folder)
    run("export", "so101/calibration.json", "--format", "urdf", "--out", "tip.urdf", "--force", "--quiet", cwd=folder)
    motors, robot = json.loads((folder / "tip.json").read_text()), poecal.Robot.from_urdf(folder / "tip.urdf")
    controller = json.loads((folder / "so101/calibration.json").read_text())["controller"]["readings"]
    for row in rows()[:5]:
        exact, by_file = [], []
        for reading in controller:
            name = reading["reading"]
            factor = reading["columns"][name]["factor"]
            ticks = float(row[f"{name}[ticks]"])
            exact.append(factor * ticks * 2 * math.pi / 4096 + reading["offset"])
            raw = ticks + MOTORS[name]["homing_offset"]
            by_file.append(factor * math.radians(lerobot_degrees(motors[name], raw)))
        # Half a tick of each of five joints.
        assert numpy.abs(numpy.subtract(exact, by_file)).max() <= math.radians(0.5 / TICK) + 1e-12
        rounding = numpy.subtract(by_file, exact)
        tips = robot.forward_kinematics(numpy.array([exact, numpy.array(by_file) - rounding]))
        assert numpy.linalg.norm(tips[0][:3, 3] - tips[1][:3, 3]) < 1e-6


@pytest.mark.parametrize(("unit", "value"), [("deg", lambda motor, ticks: (ticks - (motor["range_min"] + motor["range_max"]) / 2) * 360 / 4095), ("%", lambda motor, ticks: (ticks - motor["range_min"]) / (motor["range_max"] - motor["range_min"]) * 200 - 100)])
def test_degrees_and_per_cent_are_the_same_readings(calibrated, tmp_path, unit, value):
    names = [name for name in MOTORS if name != "gripper"]
    table = ["image," + ",".join(f"{name}.pos[{unit}]" for name in names)]
    for row in rows():
        table.append(",".join([row["image"], *(repr(value(MOTORS[name], float(row[f"{name}[ticks]"]))) for name in names)]))
    (tmp_path / "other.csv").write_text("\n".join(table) + "\n")
    model = poecal.Robot.from_urdf(SO101 / "robot.urdf")
    read = [
        poecal.Measurements.from_files([path, SO101 / "corners.csv"], model, columns=SO101 / "follower.json", cameras=[str(SO101 / "camera.csv")], markers=["charuco:7x5:36mm:26mm:DICT_4X4_50"])
        for path in (SO101 / "motors.csv", tmp_path / "other.csv")
    ]
    assert numpy.abs(read[0].joints - read[1].joints).max() < 1e-9


def change(name, edit):
    motors = json.loads((SO101 / "follower.json").read_text())
    edit(motors)
    name.write_text(json.dumps(motors))
    return name


@pytest.mark.parametrize(
    ("edit", "sentence"),
    [
        (lambda motors: motors.pop("elbow_flex"), "found no motor of joint `elbow_flex` among"),
        (lambda motors: [motors.update({f"joint_{k}": motors.pop(name)}) for k, name in enumerate(list(motors))], "found no motor of joint `shoulder_pan` among"),
        (lambda motors: motors["shoulder_lift"].update(range_min=2000, range_max=2100), "expected 2000 to 2100, the range of the motor"),
        (lambda motors: motors["shoulder_lift"].update(range_min=3000, range_max=2100), "found a range from 3000 to 2100"),
        (lambda motors: motors["shoulder_lift"].update(speed=3), "expected a mapping (TOML), or LeRobot's calibration of motors"),
    ],
)
def test_files_of_other_arms_are_refused(tmp_path, edit, sentence):
    wrong = change(tmp_path / "wrong.json", edit)
    words = run("calibrate", SO101 / "robot.urdf", SO101 / "motors.csv", SO101 / "corners.csv", "--columns", wrong, *CAMERA, "--out", "out", cwd=tmp_path, code=2)
    assert sentence in " ".join(words.split()) and not (tmp_path / "out").exists()


def test_a_column_without_unit_and_a_missing_one_are_refused(tmp_path):
    text = (SO101 / "motors.csv").read_text()
    for change_of, sentence in [(("elbow_flex[ticks]", "elbow_flex"), "found no unit of `elbow_flex`, expected [ticks]"), (("elbow_flex[ticks]", "elbow[ticks]"), "no column `elbow_flex`")]:
        (tmp_path / "motors.csv").write_text(text.replace(*change_of))
        words = run("calibrate", SO101 / "robot.urdf", "motors.csv", SO101 / "corners.csv", "--columns", SO101 / "follower.json", *CAMERA, "--out", "out", cwd=tmp_path, code=2)
        assert sentence in " ".join(words.split())


PLAYED = """
import sys, types, runpy
import numpy
frames = iter(range(100))
lerobot, motors, feetech, cv2 = (types.ModuleType(name) for name in ("lerobot", "lerobot.motors", "lerobot.motors.feetech", "cv2"))
class Bus:
    def __init__(self, port, motors): self.motors = motors; print("bus", port, *motors)
    def connect(self): pass
    def disconnect(self): pass
    def enable_torque(self): self.is_locked = True
    def disable_torque(self): self.is_locked = False
    def sync_read(self, name, normalize):
        assert name == "Present_Position" and not normalize and self.is_locked
        return {motor: 2000 + at for at, motor in enumerate(self.motors)}
class Camera:
    def __init__(self, index): pass
    def read(self): return True, numpy.zeros((4, 4, 3), "uint8")
motors.Motor, motors.MotorNormMode = (lambda *words: words), types.SimpleNamespace(DEGREES="degrees")
feetech.FeetechMotorsBus = Bus
cv2.VideoCapture, cv2.imwrite = Camera, lambda path, picture: open(path, "wb").close()
sys.modules.update({"lerobot": lerobot, "lerobot.motors": motors, "lerobot.motors.feetech": feetech, "cv2": cv2})
import time; time.sleep = lambda seconds: None
sys.argv = sys.argv[1:]
runpy.run_path(sys.argv[0], run_name="__main__")
"""


def test_the_script_records_pictures_and_positions(tmp_path):
    played = subprocess.run([sys.executable, "-c", PLAYED, SO101 / "record.py", "/dev/ttyACM0", SO101 / "follower.json", "0", "session"], cwd=tmp_path, input="\n\nq\n", capture_output=True, text=True)
    assert played.returncode == 0, played.stderr
    assert (tmp_path / "session/motors.csv").read_text().splitlines() == ["image," + ",".join(f"{name}[ticks]" for name in MOTORS), *(f"{k:03}.png,2000,2001,2002,2003,2004,2005" for k in (1, 2))]
    assert sorted(path.name for path in Path(tmp_path / "session").glob("*.png")) == ["001.png", "002.png"]
    assert len((SO101 / "record.py").read_text().splitlines()) <= 40
