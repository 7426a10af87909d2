"""The Python package returns the program's results, to the last digit, and has a place for every option of it."""

import json
import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import poecal
import pytest
from program import ELBOW, ROOT, URDFS, predict, write_table
from program import poecal as program

POINTS = ROOT / "examples/elbow/points.csv"
GUIDE = ROOT / "docs/python.md"
# Options of `poecal calibrate` with the arguments that mean the same.
RUNS = {
    "as it is": ([], {}),
    "noise": (["--sigma-position", "0.05mm", "--sigma-rotation", "0.01deg"], {"sigma_position_mm": 0.05, "sigma_rotation_deg": 0.01}),
    "tolerance": (["--tolerance", "1deg,10mm"], {"tolerance_deg_mm": (1.0, 10.0)}),
    "nothing believed": (["--tolerance", "none"], {"tolerance_deg_mm": None}),
    "held out": (["--held-out", "0.2", "--seed", "7"], {"held_out": 0.2, "seed": 7}),
    "every row": (["--held-out", "0"], {"held_out": 0}),
    "robust": (["--robust", "cauchy"], {"robust": "cauchy"}),
    "not repaired": (["--repair", "off"], {"repair": "off"}),
    "free screws": (["--formulation", "screw-offsets"], {"formulation": "screw-offsets"}),
    "method": (["--method", "gauss-newton"], {"method": "gauss-newton"}),
}  # fmt: skip


@pytest.fixture(scope="module")
def poses(tmp_path_factory) -> Path:
    """A file of 40 poses with noise."""
    folder = tmp_path_factory.mktemp("session") / "made"
    program("simulate", ELBOW, "--out", folder, "--count", 40, "--seed", 3)
    return folder / "measurements.csv"


def files(folder: Path, leave_out: str) -> dict[str, str]:
    """Texts of results; without the command, which only the program knows."""
    texts = {path.name: path.read_text() for path in sorted(folder.iterdir()) if path.name != leave_out}
    texts["calibration.json"] = re.sub(r'"command": ("[^\n]*"|null)', '"command": …', texts["calibration.json"])
    return texts


@pytest.mark.parametrize("run", RUNS)
def test_calibrations_have_the_same_figures(run, tmp_path):
    flags, arguments = RUNS[run]
    printed = program("calibrate", ELBOW, POINTS, "--out", tmp_path / "program", *flags)
    robot = poecal.Robot.read(ELBOW)
    calibration = poecal.calibrate(robot, poecal.Measurements.from_csv(POINTS, robot), **arguments)
    calibration.write(tmp_path / "package")
    # The report states the command.
    ours, theirs = (files(tmp_path / name, "report.html") for name in ["package", "program"])
    assert list(ours) == list(theirs) == ["calibrated.urdf", "calibration.json", "residuals.csv"]
    for name in ours:
        assert ours[name] == theirs[name], name
    assert printed.startswith(str(calibration))


def test_poses_with_the_papers_residual_have_the_same_figures(poses, tmp_path):
    flags = ["--residual", "spatial"]
    program("calibrate", ELBOW, poses, "--out", tmp_path / "program", *flags)
    robot = poecal.Robot.from_urdf(ELBOW)
    measured = poecal.Measurements.from_csv([poses], robot)
    poecal.calibrate(robot, measured, residual="spatial").write(tmp_path / "package", report=False)
    assert files(tmp_path / "package", "report.html") == files(tmp_path / "program", "report.html")


def test_other_files_judge_with_the_same_figures(poses, tmp_path):
    _, *rows = poses.read_text().splitlines()
    (tmp_path / "a.csv").write_text("\n".join(rows[:31]) + "\n")
    (tmp_path / "b.csv").write_text("\n".join([rows[0], *rows[31:]]) + "\n")
    program("calibrate", ELBOW, tmp_path / "a.csv", "--validate", tmp_path / "b.csv", "--out", tmp_path / "program")
    robot = poecal.Robot.read(ELBOW)
    a, b = (poecal.Measurements.from_csv(tmp_path / name, robot) for name in ["a.csv", "b.csv"])
    calibration = poecal.calibrate(robot, a, validate=b)
    calibration.write(tmp_path / "package")
    assert files(tmp_path / "package", "report.html") == files(tmp_path / "program", "report.html")
    assert calibration.accuracy.held_out.count == 10
    with pytest.raises(poecal.OptionError, match="found this file to be fitted and in validate"):
        poecal.calibrate(robot, a, validate=a)


def test_reports_are_the_same(tmp_path):
    program("calibrate", ELBOW, POINTS, "--out", tmp_path / "out")
    calibration = poecal.Calibration.read(tmp_path / "out/calibration.json")
    calibration.report(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_bytes() == (tmp_path / "out/report.html").read_bytes()


def test_predictions_judgements_and_foresight_are_the_same(poses, tmp_path):
    program("calibrate", ELBOW, POINTS, "--out", tmp_path / "out")
    path = tmp_path / "out/calibration.json"
    calibration = poecal.Calibration.read(path)
    joints = np.random.default_rng(5).uniform(-1, 1, (25, 6))
    table = tmp_path / "joints.csv"
    write_table(table, {f"joint{i + 1}": joints[:, i] for i in range(6)})
    assert (poecal.read_joints(table, calibration.robot) == joints).all()
    for frame in ["base", "device"]:
        assert (calibration.predict(joints, output_frame=frame)[:, :3, 3] == predict(path, table, "--output-frame", frame)[:, :3]).all()
    rows = program("predict", path, table, "--with-uncertainty").splitlines()[1:]
    columns = list(zip(*(row.split(",") for row in rows), strict=True))
    found = calibration.predict(joints, with_uncertainty=True)
    for column, values in [(7, found.sigma_position_m), (8, found.sigma_rotation_rad), (9, found.bound95_position_m)]:
        assert [float(cell) for cell in columns[column]] == values.tolist()
    assert [cell == "true" for cell in columns[10]] == found.inside_sampled_range.tolist()

    measured = poecal.Measurements.from_csv(POINTS, calibration.robot)
    for flags, arguments in [([], {}), (["--refit", "device,tool"], {"refit": ["device", "tool"]})]:
        judged = json.loads(program("validate", path, POINTS, "--json", *flags))
        # The package does not know the command.
        del judged["inputs"]["command"]
        assert calibration.validate(measured, **arguments).to_dict() == judged
    checked = ["--refit", "device", "--record", "operator=Mia"]
    program("validate", path, POINTS, *checked, "--out", tmp_path / "program", "--history", tmp_path / "program.jsonl")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", poecal.PoecalWarning)
        calibration.validate(measured, refit="device", record={"operator": "Mia"}, out=tmp_path / "package", history=tmp_path / "package.jsonl")
    assert (tmp_path / "package/errors.csv").read_bytes() == (tmp_path / "program/errors.csv").read_bytes()
    lines = [json.loads((tmp_path / f"{name}.jsonl").read_text()) for name in ["program", "package"]]
    del lines[0]["inputs"]["command"]
    assert lines[0].pop("time") <= lines[1].pop("time") and lines[0] == lines[1]
    with pytest.raises(poecal.FileError, match="output folder exists"):
        calibration.validate(measured, out=tmp_path / "package")

    foreseen = json.loads(program("plan", path, "--rows", table, "--kind", "point", "--json"))
    found = calibration.identify(joints, kind="point").to_dict()
    for theirs in [foreseen, found]:
        del theirs["files"], theirs["model"]
    assert found == foreseen


def test_checks_offsets_and_forms_are_the_same(tmp_path):
    robot = poecal.Robot.read(ELBOW)
    measured = poecal.Measurements.from_csv(POINTS, robot)
    assert poecal.check(robot, measured).to_json() == program("check", ELBOW, POINTS, "--json")
    assert program("check", ELBOW, POINTS) == str(poecal.check(robot, measured))
    program("calibrate", ELBOW, POINTS, "--out", tmp_path / "out")
    actual = poecal.Robot.read(tmp_path / "out/calibration.json")
    assert poecal.offsets(robot, actual).to_json() == program("offsets", ELBOW, tmp_path / "out/calibration.json", "--json")
    kept = ["--fix", "base", "--free", "tip", "--json"]
    assert poecal.offsets(robot, actual, fix=["base"], free=["tip"]).to_json() == program("offsets", ELBOW, actual.path, *kept)
    assert poecal.schema() == program("schema")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", poecal.PoecalWarning)
        for path in sorted(URDFS.glob("*.urdf")):
            robot = poecal.Robot.from_urdf(path)
            for form in ["urdf", "toml"]:
                assert robot.to_text(form) == program("export", path, "--format", form)
        offset = {"joint2": np.radians(0.5)}
        assert poecal.export(actual, format="toml", offset=offset) == program("export", actual.path, "--format", "toml", "--offset", "joint2=0.5deg")


def test_simulations_are_the_same(tmp_path):
    flags = ["--kind", "mixed", "--count", "30", "--seed", "4", "--errors", "0.5deg,1mm", "--noise", "0.02mm,0.02deg", "--held-out-count", "5"]
    program("simulate", ELBOW, "--out", tmp_path / "program", *flags)
    options = {"error_position_mm": 1, "error_rotation_deg": 0.5, "noise_position_mm": 0.02, "noise_rotation_deg": 0.02}
    made = poecal.simulate(poecal.Robot.read(ELBOW), kind="mixed", count=30, seed=4, held_out_count=5, **options)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", poecal.PoecalWarning)
        made.write(tmp_path / "package")
    for path in sorted((tmp_path / "program").iterdir()):
        ours, theirs = ((tmp_path / name / path.name).read_text() for name in ["package", "program"])
        # The command that makes it again is the program's, or Python's.
        assert re.sub(r"simulated by.*|\"command\".*", "", ours) == re.sub(r"simulated by.*|\"command\".*", "", theirs), path.name


def test_the_wheel_installs_the_program(tmp_path):
    installed = Path(sys.executable).with_name("poecal")
    for arguments in [["check", ELBOW, POINTS, "--json"], ["predict", "nowhere"], ["--help"], ["calibrate"], ["export", ELBOW, "--format", "toml"]]:
        ours = subprocess.run([installed, *arguments], capture_output=True, text=True, env=os.environ | {"COLUMNS": "100"})
        theirs = subprocess.run([os.environ["POECAL_PROGRAM"], *arguments], capture_output=True, text=True, env=os.environ | {"COLUMNS": "100"})
        assert (ours.returncode, ours.stdout, ours.stderr) == (theirs.returncode, theirs.stdout, theirs.stderr)


def options_of(command: list[str]) -> set[str]:
    """The long options that the help of a command names."""
    words = program(*command, "--help")
    found = set(re.findall(r"^ +(?:-\w, )?(--[a-z0-9-]+)", words, re.MULTILINE))
    return found - {"--help", "--version"}


def options_in(cell: str) -> list[str]:
    """Options of a row of the guide: each option behind the colon, of each command before it."""
    commands, _, options = cell.rpartition(": ")
    named = re.findall(r"`([^`]+)`", options)
    return [f"`{command} {option}`" for command in re.findall(r"`([^`]+)`", commands) for option in named] if commands else [f"`{option}`" for option in named]


def test_the_guide_has_a_place_for_every_option():
    """Each command and each of its options is in the table of docs/python.md, with its equivalent in Python or the reason why there is none."""
    guide = GUIDE.read_text().split("## The program in Python\n")[1]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in guide.splitlines() if line.startswith("| `")]
    named = [(option, row[1]) for row in rows for option in options_in(row[0])]
    table = dict(named)
    assert len(named) == len(table), "an option stands twice"
    commands = re.findall(r"^  ([a-z0-9-]+) ", program("--help").split("<COMMAND>")[1].split("Options:")[0], re.MULTILINE)
    commands += ["schema", "reproduce", "completions", "man"]  # not on the first screen
    everywhere = {"--quiet", "--threads", "--limit", "--wait"}
    expected = {f"`{option}`" for option in everywhere}
    for command in commands:
        expected.add(f"`poecal {command}`")
        expected |= {f"`{command} {option}`" for option in options_of([command]) - everywhere}
    # A word of its own for the change of a tip.
    expected.add("`compare --limit`")
    assert expected - set(table) == set(), "options without a place"
    assert set(table) - expected == set(), "places without an option"
    for option, place in table.items():
        assert place.startswith("not in Python") or "`" in place, option
