"""Sentences that advise what to write are followed literally, and their cause is gone then.

FOLLOWED lists every such sentence of the program by a part of its text, with the test that follows it; a sentence of the sources that is
missing there fails, and so does an entry that no source has.
"""

import json
import re
import subprocess
from pathlib import Path

import pytest
from program import ROOT, program

ELBOW = ROOT / "examples/elbow"
MODEL = (ELBOW / "robot.urdf").read_text()
POINTS = [line for line in (ELBOW / "points.csv").read_text().splitlines() if line and not line.startswith("#")]
# The program and all parts of the library, without the crates beside them.
BESIDE = {f"poecal-{name}" for name in ("arm", "c", "detect", "fuzz", "lou2009", "py", "testing", "wasm")}
CRATES = sorted(path for path in (ROOT / "crates").glob("*/src") if path.parent.name not in BESIDE)
# Pattern of a sentence that advises what to write.
ADVICE = re.compile(r"write `|write \{|state it by|in a mapping\b|into a mapping|a mapping file|put `#`|expand the file|expected another: take|: take `|: take --board|\(--columns\)|by --start|`--third-axis")

HERE = "test_advice.py::"
FOLLOWED = {
    "put `#` in front of a line that is no row": HERE + "test_a_line_that_is_no_row",
    "write `{si}`": HERE + "test_a_unit_that_is_missing_in_the_line_of_units",
    "has it: put `#` in front of the lines above it": HERE + "test_lines_above_the_header",
    "state it by --lag, like": "crates/poecal-import/tests/it/stands.rs::a_program_that_repeats_itself_is_refused_until_the_lag_is_stated",
    "if they are {unit}, write `time[{unit}]` in the header": "crates/poecal-cli/tests/it/recordings.rs::a_log_without_usable_times_is_refused_at_once_and_says_why",
    "or number them in a mapping (--columns), like": "crates/poecal-import/tests/it/mapping_forms.rs::columns_of_a_table_without_names_are_named_by_their_numbers",
    "export them with comments, or name the columns by number in a mapping (--columns)": HERE + "test_points_without_a_unit",
    "expected one that was measured: name its columns in a mapping (--columns)": HERE + "test_two_sets_of_coordinates",
    "since angles do not state their convention, which a mapping does (--columns)": HERE + "test_two_sets_of_coordinates",
    "is meant, write `{name}[{}]`": HERE + "test_a_unit_in_a_name",
    "which a mapping (--columns) reads by lines under `[joints]` such as": HERE + "test_counts_of_an_encoder",
    "spread over {} mm, expected about the same: most likely they are in rad": HERE + "test_radians_that_are_called_degrees",
    "most likely they are in {}, not {}": HERE + "test_millimetres_that_are_called_metres",
    "write `{}[{symbol}]` in the header": HERE + "test_degrees_without_a_unit",
    "most likely {smaller}; write `{}` in the header": HERE + "test_millimetres_that_are_called_metres",
    "rename or add a column, or name the right one in a mapping file (--columns)": HERE + "test_a_column_of_another_name",
    "name them in a mapping file (--columns)": "crates/poecal-import/tests/it/measurement_errors.rs",
    "and say so with `joints": HERE + "test_a_joint_that_is_called_x",
    "add the missing cells (they may be empty), or put `#`": HERE + "test_a_line_that_is_no_row",
    "{why}; in a mapping file: `[joints]` and below it": "crates/poecal-cli/tests/it/diagnosis.rs::readings_in_per_cent_of_the_range_are_named_with_the_mapping_that_reads_them",
    'then write `third_axis': "crates/poecal-cli/tests/it/counted.rs::a_third_axis_that_counts_from_the_level_is_named_with_the_line_that_reads_it",
    "check whether the controller states {name} together with {before}": HERE + "test_a_coupling",
    "(poses of the device in the target: `pose": HERE + "test_poses_the_other_way",
    "or in a mapping (`unit": HERE + "test_angles_in_another_unit",
    "check the convention of the angles; a mapping (--columns) with": "crates/poecal-cli/tests/it/diagnosis.rs::angles_of_a_controller_that_are_called_roll_pitch_yaw_are_named_with_the_mapping_that_reads_them",
    "take `--format hayati`": "crates/poecal-results/tests/it/export.rs",
    "write `third_axis = ": HERE + "test_options_of_programs",
    "state it by --factors": HERE + "test_a_factor",
    "expand the file with `xacro": HERE + "test_remains_of_xacro",
    "expand the file first with `xacro": "needs xacro itself",
    "write `lower=": HERE + "test_degrees_in_a_urdf",
    "write `rpy=": HERE + "test_degrees_in_a_urdf",
    "is not in the file: state it by {flag}": HERE + "test_options_of_programs",
    "the tool is not known: state it by --tool": HERE + "test_options_of_programs",
    "the frame is not known: state it by --work-object": HERE + "test_options_of_programs",
    "is not in this file: state it by {flag}": HERE + "test_options_of_programs",
    "its frame is stated in no line of this file: state it by --work-object NAME=": "crates/poecal-compensate/tests/it/programs/urscript.rs",
    "state where the robot starts by --start": HERE + "test_options_of_programs",
    "do not show from where the third axis counts": "crates/poecal-cli/tests/it/counted.rs::a_third_axis_is_stated_where_rows_do_not_show_it",
    "which are not all here: took these": "crates/poecal-cli/tests/it/counted.rs::tables_are_read_and_written_as_the_controller_counts",
    "they are ignored and the rows read as points: a mapping (--columns) with {mapping} reads them as poses": HERE + "test_angles_of_makers",
    "`ignore = [{}]` in a mapping leaves them out": HERE + "test_angles_of_a_maker_that_are_left_out",
    "they are these, a mapping (--columns) with {} has them read so": HERE + "test_angles_of_makers",
    "if they are millimetres, write `[mm]` behind the names of their columns, or --units mm": HERE + "test_lengths_of_poses",
    "if they are metres, write `[m]` behind the names of their columns, or --units m": HERE + "test_lengths_of_poses",
    "if the column is in degrees, write `[deg]` behind its name{option}": HERE + "test_angles_of_poses",
    ": take --board {}": "crates/poecal-cli/tests/it/detect.rs::the_board_that_a_message_names_is_found",
    "write `[{short}]` behind the names of these columns": HERE + "test_angles_of_poses",
}


def sentences() -> list[str]:
    """Text of every source line, without tests and comments, that advises what to write; with the lines around it, since sentences are long."""
    found = []
    for crate in CRATES:
        for path in sorted(crate.rglob("*.rs")):
            lines = path.read_text().split("#[cfg(test)]")[0].splitlines()
            for at, line in enumerate(lines):
                if not line.lstrip().startswith("//") and '"' in "".join(lines[max(at - 3, 0) : at + 1]) and ADVICE.search(line):
                    found.append(f"{path.relative_to(ROOT)}:{at + 1}: " + " ".join(it.strip().rstrip("\\").strip() for it in lines[max(at - 3, 0) : at + 3]))
    return found


def test_every_sentence_that_says_what_to_write_has_a_test_that_follows_it():
    found = sentences()
    missing = [it for it in found if not any(part in it.replace('\\"', '"') for part in FOLLOWED)]
    assert not missing, "\n".join(missing)
    whole = "\n".join(found).replace('\\"', '"')
    assert not [part for part in FOLLOWED if part not in whole]
    here = Path(__file__).read_text()
    for test in FOLLOWED.values():
        place, _, name = test.partition("::")
        if name:
            assert f"{name}(" in (here if place == HERE[:-2] else (ROOT / place).read_text()), test
    print(f"{len(found)} places, {len(FOLLOWED)} sentences")


def run(folder: Path, *words: str, code: int = 0) -> str:
    """Output of a run, on one line; it ends with one of these codes."""
    done = subprocess.run([program(), *words], cwd=folder, capture_output=True, text=True)
    said = " ".join((done.stdout + done.stderr).split())
    assert done.returncode == code, f"{words}: {done.returncode}\n{said}"
    return said


@pytest.fixture
def here(tmp_path) -> Path:
    (tmp_path / "robot.urdf").write_text(MODEL)
    (tmp_path / "points.csv").write_text("\n".join(POINTS) + "\n")
    return tmp_path


def table(folder: Path, header: str, rows: list[str], name: str = "points.csv") -> None:
    (folder / name).write_text("\n".join([header, *rows]) + "\n")


def calibrates(folder: Path, *words: str) -> None:
    assert run(folder, "calibrate", "robot.urdf", "points.csv", "--out", "out", "--force", *words).startswith("verdict good")


@pytest.mark.parametrize("line", ["start of the second day", "start,of,the,second,day,,x,y,z"])
def test_a_line_that_is_no_row(here, line):
    rows = [*POINTS[1:40], line, *POINTS[40:]]
    table(here, POINTS[0], rows)
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    assert "put `#` in front of a line that is no row" in said
    table(here, POINTS[0], [it if it != line else f"# {it}" for it in rows])
    calibrates(here)


def test_a_unit_that_is_missing_in_the_line_of_units(here):
    names = [it.split("[")[0] for it in POINTS[0].split(",")]
    units = ["deg"] * 6 + ["mm", "", "mm"]
    rows = [row.split(",") for row in POINTS[1:]]
    table(here, ",".join(names), [",".join(units), *(",".join(row) for row in rows)])
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    unit = re.search(r"write `(\w+)` there if it is in", said)[1]
    units[7] = unit
    for row in rows:
        row[7] = repr(float(row[7]) / 1000)
    table(here, ",".join(names), [",".join(units), *(",".join(row) for row in rows)])
    calibrates(here)


def test_lines_above_the_header(here):
    # Lines that are evidently no data are skipped.
    table(here, "Cell 4, line 2,,,,,,,", ["operator,N. N.,,,,,,,", POINTS[0], *POINTS[1:]])
    calibrates(here)
    # Lines with as many cells may be names.
    table(here, "cell 4,line 2,a,b,c,d,e,f,g", [POINTS[0], *POINTS[1:]])
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "skipped", code=2)
    skip = re.search(r"write `(skip_lines = \d+)` in a mapping file", said)[1]
    (here / "map.toml").write_text(skip + "\n")
    calibrates(here, "--columns", "map.toml")
    table(here, "#Cell 4, line 2,,,,,,,", ["#operator,N. N.,,,,,,,", POINTS[0], *POINTS[1:]])
    calibrates(here)


def test_counts_of_an_encoder(here):
    names = [it.split("[")[0] for it in POINTS[0].split(",")[:6]]
    rows = []
    for row in POINTS[1:]:
        cells = row.split(",")
        turns = [(float(it) + 180) % 360 for it in cells[:6]]
        rows.append(",".join([f"{min(it * 4096 / 360, 4095):.0f}" for it in turns] + cells[6:]))
    table(here, ",".join([*names, *POINTS[0].split(",")[6:]]), rows)
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    line = re.search(r"`\[joints\]` such as `(joint\d = .*offset = -180 \})`", said)[1]
    joint = line.split(" ")[0]
    (here / "map.toml").write_text("\n".join(["[joints]", *(line.replace(joint, name) for name in names)]) + "\n")
    # A count is 0.088 deg.
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--columns", "map.toml", "--out", "out")
    assert said.startswith(("verdict good", "verdict use inside the sampled range"))


def test_points_without_a_unit(here):
    rows = [row.split(",") for row in POINTS[1:]]
    (here / "joints.csv").write_text("\n".join([",".join(POINTS[0].split(",")[:6]), *(",".join(row[:6]) for row in rows)]) + "\n")
    points = "\n".join(f"Robot, P{number}, {', '.join(row[6:9])}" for number, row in enumerate(rows, 1)) + "\n"
    (here / "points.txt").write_text("// SpatialAnalyzer\n" + points)
    said = run(here, "calibrate", "robot.urdf", "joints.csv", "points.txt", "--out", "out", code=2)
    assert "export them with comments" in said
    (here / "points.txt").write_text("// SpatialAnalyzer\n// AXES = CARTESIAN: X,  Y,  Z (mm)\n" + points)
    run(here, "calibrate", "robot.urdf", "joints.csv", "points.txt", "--out", "out")


def test_two_sets_of_coordinates(here):
    rows = [row.split(",") for row in POINTS[1:]]
    (here / "joints.csv").write_text("\n".join([",".join(POINTS[0].split(",")[:6]), *(",".join(row[:6]) for row in rows)]) + "\n")
    places = [[float(cell) for cell in row[6:9]] for row in rows]
    both = "".join(",".join(map(repr, [*place, *(value + 0.2 for value in place)])) + "\n" for place in places)
    (here / "report.csv").write_text("x[mm],y[mm],z[mm],x[mm],y[mm],z[mm]\n" + both)
    said = run(here, "calibrate", "robot.urdf", "joints.csv", "report.csv", "--out", "out", code=2)
    assert "found two sets of coordinates in a row" in said and "in a mapping (--columns)" in said
    (here / "map.toml").write_text("position = { columns = [4, 5, 6] }\n")
    run(here, "calibrate", "robot.urdf", "joints.csv", "report.csv", "--columns", "map.toml", "--out", "out")
    # Angles, which a mapping reads.
    names = [f"{word} {name}" for word in ("Nominal", "Measured") for name in ("x[mm]", "y[mm]", "z[mm]", "a[deg]", "b[deg]", "c[deg]")]
    posed = "".join(",".join(map(repr, [*(value + 0.2 for value in place), 1.5, 2.5, 3.5, *place, 1.5, 2.5, 3.5])) + "\n" for place in places)
    (here / "report.csv").write_text(",".join(names) + "\n" + posed)
    said = run(here, "check", "robot.urdf", "joints.csv", "report.csv")
    assert "the positions alone, since angles do not state their convention" in said and "100 points" in said
    orientation = 'orientation = { form = "intrinsic_zyx", columns = ["Measured a", "Measured b", "Measured c"] }\n'
    (here / "map.toml").write_text('position = { columns = ["Measured x", "Measured y", "Measured z"] }\n' + orientation)
    assert "100 poses" in run(here, "check", "robot.urdf", "joints.csv", "report.csv", "--columns", "map.toml")


def test_a_unit_in_a_name(here):
    header = POINTS[0].replace("y[mm]", "y_mm")
    table(here, header, POINTS[1:])
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    found, meant = re.search(r"if `(\S+)` is meant, write `(\S+)`", said).groups()
    table(here, header.replace(found, meant), POINTS[1:])
    calibrates(here)


def radians(rows: list[str]) -> list[str]:
    return [",".join([*(repr(float(it) * 3.141592653589793 / 180) for it in row.split(",")[:6]), *row.split(",")[6:]]) for row in rows]


def test_radians_that_are_called_degrees(here):
    table(here, POINTS[0], radians(POINTS[1:]))
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    assert "write `joint1[rad]` in the header (and so for each joint)" in said
    table(here, POINTS[0].replace("[deg]", "[rad]"), radians(POINTS[1:]))
    calibrates(here)


@pytest.mark.parametrize("scale", [1, 5])
def test_millimetres_that_are_called_metres(here, scale):
    rows = [",".join([*row.split(",")[:6], *(repr(float(it) * scale) for it in row.split(",")[6:])]) for row in POINTS[1:]]
    table(here, POINTS[0].replace("[mm]", "[m]"), rows)
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    written = re.search(r"write `(x\[\w+\]),(y\[\w+\]),(z\[\w+\])`", said).groups()
    assert written == ("x[mm]", "y[mm]", "z[mm]")
    header = POINTS[0]
    for name in written:
        header = re.sub(rf"{name[0]}\[\w+\]", name, header)
    table(here, header, POINTS[1:])
    calibrates(here)


@pytest.mark.parametrize("unit", ["cm", "in"])
def test_millimetres_that_are_called_centimetres_or_inches(here, unit):
    table(here, POINTS[0].replace("[mm]", f"[{unit}]"), POINTS[1:])
    for command in ("check", "calibrate"):
        said = run(here, command, "robot.urdf", "points.csv", code=2)
        assert "write `x[mm],y[mm],z[mm]` in the header" in said, said
    table(here, POINTS[0], POINTS[1:])
    calibrates(here)


@pytest.mark.parametrize("name", ["x", "y", "z"])
def test_one_column_that_is_called_metres(here, name):
    table(here, POINTS[0].replace(f"{name}[mm]", f"{name}[m]"), POINTS[1:])
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    (written,) = re.search(r"write `(\w\[\w+\])` in", said).groups()
    assert written == f"{name}[mm]" and f"found values of `{name}`" in said
    table(here, POINTS[0].replace(f"{name}[mm]", written), POINTS[1:])
    calibrates(here)


def test_degrees_without_a_unit(here):
    table(here, POINTS[0].replace("[deg]", ""), POINTS[1:])
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    joint, unit = re.search(r"write `(\w+)\[(\w+)\]` in the header", said).groups()
    assert joint.startswith("joint")
    table(here, re.sub(r"(joint\d)\[deg\]", rf"\1[{unit}]", POINTS[0]), POINTS[1:])
    calibrates(here)
    # Or the unit in the mapping.
    table(here, POINTS[0].replace("[deg]", ""), POINTS[1:])
    (here / "map.toml").write_text(f'[units]\nangle = "{unit}"\n')
    calibrates(here, "--columns", "map.toml")


def test_a_column_of_another_name(here):
    header = POINTS[0].replace("joint4", "wrist")
    table(here, header, POINTS[1:])
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    assert "rename or add a column, or name the right one in a mapping file (--columns)" in said
    (here / "map.toml").write_text('[joints]\njoint4 = "wrist"\n')
    calibrates(here, "--columns", "map.toml")


def test_a_joint_that_is_called_x(here):
    (here / "robot.urdf").write_text(MODEL.replace('"joint1"', '"x"'))
    header = POINTS[0].replace("joint1", "x")
    table(here, header, POINTS[1:])
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    name, line = re.search(r"call the joint's column `(\w+)`, and say so with `([^`]+)` in a mapping file", said).groups()
    table(here, header.replace("x[deg]", f"{name}[deg]"), POINTS[1:])
    (here / "map.toml").write_text(line + "\n")
    calibrates(here, "--columns", "map.toml")


def test_a_coupling(here):
    """Joint 4 counted together with joint 3."""
    rows = [row.split(",") for row in POINTS[1:]]
    for row in rows:
        row[3] = repr(float(row[3]) - float(row[2]))
    table(here, POINTS[0], [",".join(row) for row in rows])
    said = run(here, "check", "robot.urdf", "points.csv")
    first, second = re.search(r"in a mapping file: `(\[joints\])` and below it `([^`]+)`", said).groups()
    (here / "map.toml").write_text(f"{first}\n{second}\n")
    calibrates(here, "--columns", "map.toml")


def poses(folder: Path) -> list[list[str]]:
    """A session of poses, header first."""
    run(folder, "simulate", "robot.urdf", "--kind", "pose", "--count", "60", "--out", "made", "--force")
    lines = (folder / "made/measurements.csv").read_text().splitlines()
    return [line.split(",") for line in lines if line and not line.startswith("#")]


def test_poses_the_other_way(here):
    import numpy as np

    header, *rows = poses(here)
    at = [next(k for k, name in enumerate(header) if name.split("[")[0] == column) for column in ("x", "y", "z", "qx", "qy", "qz", "qw")]
    for row in rows:
        *place, x, y, z, w = (float(row[k]) for k in at)
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        inverse = [*(-turn.T @ place), -x, -y, -z, w]
        for k, value in zip(at, inverse, strict=True):
            row[k] = repr(float(value))
    table(here, ",".join(header), [",".join(row) for row in rows])
    said = run(here, "check", "robot.urdf", "points.csv")
    line = re.search(r"\(poses of the device in the target: `([^`]+)` in a mapping\)", said)[1]
    (here / "map.toml").write_text(line + "\n")
    calibrates(here, "--columns", "map.toml")


def test_angles_in_another_unit(here):
    import numpy as np

    header, *rows = poses(here)
    first = next(k for k, name in enumerate(header) if name.startswith("qx"))
    made = []
    for row in rows:
        x, y, z, w = (float(it) for it in row[first : first + 4])
        angles = [np.arctan2(2 * (y * z + x * w), 1 - 2 * (x * x + y * y)), np.arcsin(2 * (y * w - x * z)), np.arctan2(2 * (x * y + z * w), 1 - 2 * (y * y + z * z))]
        made.append(",".join([*row[:first], *(repr(float(it)) for it in angles), *row[first + 4 :]]))
    named = [*header[:first], "roll[deg]", "pitch[deg]", "yaw[deg]", *header[first + 4 :]]
    table(here, ",".join(named), made)
    said = run(here, "check", "robot.urdf", "points.csv")
    columns = re.search(r"state the unit of the angles in the header, as in `([^`]+)`, `([^`]+)`, `([^`]+)`", said).groups()
    table(here, ",".join([*header[:first], *columns, *header[first + 4 :]]), made)
    calibrates(here)


@pytest.mark.parametrize(("names", "unit"), [(("A", "B", "C"), "[deg]"), (("A", "B", "C"), ""), (("rz", "ry", "rx"), "[deg]")])
def test_angles_of_makers(here, names, unit):
    import numpy as np

    header, *rows = poses(here)
    first = next(k for k, name in enumerate(header) if name.startswith("qx"))
    made = []
    for row in rows:
        x, y, z, w = (float(it) for it in row[first : first + 4])
        zyx = np.degrees([np.arctan2(2 * (x * y + z * w), 1 - 2 * (y * y + z * z)), np.arcsin(2 * (y * w - x * z)), np.arctan2(2 * (y * z + x * w), 1 - 2 * (x * x + y * y))])
        made.append(",".join([*row[:first], *(repr(float(it)) for it in zyx), *row[first + 4 :]]))
    table(here, ",".join([*header[:first], *(name + unit for name in names), *header[first + 4 :]]), made)
    said = run(here, "check", "robot.urdf", "points.csv")
    line = re.search(r"a mapping \(--columns\) with `(orientation = [^`]+)` (?:reads|has) them", said)[1]
    (here / "map.toml").write_text(line + "\n")
    calibrates(here, "--columns", "map.toml")
    assert "60: 60 poses" in run(here, "check", "robot.urdf", "points.csv", "--columns", "map.toml")


def test_angles_of_a_maker_that_are_left_out(here):
    header = POINTS[0].replace("x[mm]", "X[mm]").replace("y[mm]", "Y[mm]").replace("z[mm]", "Z[mm]")
    table(here, f"{header},A[deg],B[deg],C[deg]", [f"{row},10,20,30" for row in POINTS[1:]])
    said = run(here, "check", "robot.urdf", "points.csv")
    line = re.search(r"`(ignore = [^`]+)` in a mapping leaves them out", said)[1]
    (here / "map.toml").write_text(line + "\n")
    calibrates(here, "--columns", "map.toml")


def test_a_form_that_is_closed(here):
    calibrates(here)
    said = run(here, "export", "out/calibration.json", "--format", "fanuc", code=2)
    form = re.search(r"use --format (\w+) for mastering", said)[1]
    assert json.loads(subprocess.run([program(), "export", "out/calibration.json", "--format", form], cwd=here, capture_output=True, text=True, check=True).stdout)["form"] == form


def test_a_factor(here):
    rows = [f"{row},{k % 3}" for k, row in enumerate(POINTS[1:])]
    table(here, f"{POINTS[0]},payload", rows)
    run(here, "calibrate", "robot.urdf", "points.csv", "--factors", "payload", "--corrections", "payload=1", "--out", "out", "--force")
    (here / "job.csv").write_text("joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg]\n10,20,30,40,50,60\n")
    said = run(here, "compensate", "out/calibration.json", "job.csv", "--out", "a.csv")
    option, value = re.search(r"state it by (--factors) (payload=)VALUE", said).groups()
    assert "state it by" not in run(here, "compensate", "out/calibration.json", "job.csv", "--out", "b.csv", option, f"{value}1.5")


def test_remains_of_xacro(here):
    element = '<xacro:property name="a" value="1"/>'
    start = MODEL.index("<link")
    (here / "robot.urdf").write_text(MODEL[:start].replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ') + element + MODEL[start:])
    said = run(here, "calibrate", "robot.urdf", "points.csv", "--out", "out", code=2)
    assert "or, if it is expanded and this element adds no joints, delete it" in said
    (here / "robot.urdf").write_text((here / "robot.urdf").read_text().replace(element, ""))
    calibrates(here)


def test_degrees_in_a_urdf(here):
    text = MODEL
    lower, upper = re.search(r'lower="(\S+)" upper="(\S+)"', text).groups()
    wrong = text.replace(f'lower="{lower}" upper="{upper}"', 'lower="-170" upper="170"', 1)
    turned = re.search(r'rpy="([^"]*)"', wrong)[0]
    wrong = wrong.replace(turned, 'rpy="0 0 90"', 1)
    (here / "robot.urdf").write_text(wrong)
    said = run(here, "check", "robot.urdf")
    limits = re.search(r'write `(lower="\S+" upper="\S+")`', said)[1]
    rpy = re.search(r'write `(rpy="[^"]+")`', said)[1]
    (here / "robot.urdf").write_text(wrong.replace('lower="-170" upper="170"', limits).replace('rpy="0 0 90"', rpy))
    assert "look like degrees" not in run(here, "check", "robot.urdf") and "1.570796" in rpy


def hand_eye(folder: Path, header: str, rows: list[list[float]], *words: str, code: int = 0) -> str:
    (folder / "poses.csv").write_text("\n".join([header, *(",".join(map(repr, row)) for row in rows)]) + "\n")
    return run(folder, "hand-eye", "poses.csv", "--camera", "in-hand", *words, code=code)


HAND_EYE, *POSES = (ROOT / "examples/howto/hand_eye.csv").read_text().splitlines()
POSES = [[float(it) for it in row.split(",")] for row in POSES]


def test_lengths_of_poses(here):
    seen = HAND_EYE.replace("tvec_x,tvec_y,tvec_z", "tvec_x[mm],tvec_y[mm],tvec_z[mm]")
    for wrong, right in (("m", "mm"), ("mm", "m")):
        factor = 1 if right == "mm" else 1e-3
        rows = [[*(factor * it for it in row[:3]), *row[3:]] for row in POSES]
        header = seen.replace("X,Y,Z", f"X[{wrong}],Y[{wrong}],Z[{wrong}]")
        said = hand_eye(here, header, rows, code=2)
        unit, option = re.search(r"write `\[(\w+)\]` behind the names of their columns, or --units (\w+)", said).groups()
        assert unit == option == right
        assert hand_eye(here, header.replace(f"[{wrong}],", f"[{unit}],", 3), rows).startswith("verdict good")
        assert hand_eye(here, seen, rows, "--units", option).startswith("verdict good")


def test_angles_of_poses(here):
    import math

    header = HAND_EYE.replace("tvec_x,tvec_y,tvec_z", "tvec_x[mm],tvec_y[mm],tvec_z[mm]")
    named = header.replace("A,B,C", "A[rad],B[rad],C[rad]")
    said = hand_eye(here, named, POSES, code=2)
    unit, option = re.search(r"in degrees, write `\[(\w+)\]` behind its name, or --units (\w+)", said).groups()
    assert hand_eye(here, named.replace("[rad]", f"[{unit}]"), POSES).startswith("verdict good")
    assert hand_eye(here, header, POSES, "--units", option).startswith("verdict good")
    rows = [[*row[:3], *(math.radians(it) for it in row[3:6]), *row[6:]] for row in POSES]
    said = hand_eye(here, header, rows, code=2)
    unit = re.search(r"write `\[(\w+)\]` behind the names of these columns", said)[1]
    assert hand_eye(here, header.replace("A,B,C", f"A[{unit}],B[{unit}],C[{unit}]"), rows).startswith("verdict good")


def test_options_of_programs(here):
    calibrates(here)

    def listed(name: str, text: str, *words: str) -> str:
        (here / name).write_text(text)
        return run(here, "compensate", "out/calibration.json", name, "--max-correction", "20deg", "--dry-run", *words, code=1)

    def whole(name: str, *words: str) -> None:
        assert "corrected" in run(here, "compensate", "out/calibration.json", name, "--max-correction", "20deg", "--dry-run", *words)

    # The request of each sentence is added, until there is none.
    script = "movel(p[0.6, 0.1, 0.7, 0, 1.2, 0])\n"
    assert "state where the robot starts by --start" in listed("a.script", script, "--tool-data", "0,0,0,0,0,0")
    said = listed("b.script", "movej([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])\nmovel(p[0.6, 0.1, 0.7, 0, 1.2, 0])\n")
    assert "the tool is not known: state it by --tool-data" in said
    whole("a.script", "--tool-data", "0,0,0,0,0,0", "--start", "0.1,0.4,-0.3,0.2,0.8,0.1")
    places = "/PROG P\n/MN\n1:J P[1] 100% FINE ;\n/POS\nP[1]{\n GP1:\n UF : 2, UT : 3, CONFIG : 'N U T, 0, 0, 0',\n X = 700 mm, Y = 50 mm, Z = 700 mm,\n W = 0 deg, P = 60 deg, R = 5 deg\n};\n/END\n"
    said = listed("c.ls", places)
    for option in re.findall(r"state it by (--[\w-]+ \d)=X,Y,Z,W,P,R", said):
        assert option in ("--tool-data 3", "--work-object 2")
    said = listed("c.ls", places, "--tool-data", "3=0,0,0,0,0,0")
    assert "--work-object 2=X,Y,Z,W,P,R" in said and "--tool-data 3" not in said
    assert "state it by" not in listed("c.ls", places, "--tool-data", "3=0,0,0,0,0,0", "--work-object", "2=0,0,0,0,0,0")
    module = "MODULE M\nCONST robtarget p:=[[700,50,700],[1,0,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\nPROC main()\nMoveL p,v100,fine,grip\\WObj:=table;\nENDPROC\nENDMODULE\n"
    said = listed("d.mod", module)
    assert "state it by --tool-data" in said or "state it by --work-object" in said
    assert "state it by --tool-data" not in listed("d.mod", module, "--tool-data", "grip=0,0,0,1,0,0,0", "--work-object", "table=0,0,0,1,0,0,0")
    (here / "job.csv").write_text("joint1[deg],joint2[deg],joint3[deg],joint4[deg],joint5[deg],joint6[deg]\n10,20,30,40,50,60\n")
    said = run(here, "compensate", "out/calibration.json", "job.csv", "--third-axis", "arm", code=2)
    (here / "map.toml").write_text(re.search(r"write `([^`]+)` into a mapping", said)[1] + "\n")
    whole("job.csv", "--columns", "map.toml")
