"""Measurements: from arrays, data frames and files."""

import copy
import pickle
import warnings
from pathlib import Path

import numpy as np
import pandas
import poecal
import polars
import pytest
from robots import configurations, elbow, session

HEADER = ",".join(f"joint{i}[deg]" for i in range(1, 7))


def table(made: poecal.Simulation) -> dict[str, np.ndarray]:
    """Columns as in a file."""
    seen = made.measurements
    columns = {f"joint{i + 1}[deg]": np.degrees(seen.joints[:, i]) for i in range(6)}
    return columns | {f"{axis}[mm]": 1e3 * seen.positions[:, i] for i, axis in enumerate("xyz")}


def test_arrays_come_back_as_they_were():
    made = session()
    seen = made.measurements
    again = poecal.Measurements.from_arrays(elbow(), joints=seen.joints, poses=seen.poses)
    assert len(again) == 50 and again.joints.shape == (50, 6)
    assert (again.joints == seen.joints).all() and (again.positions == seen.positions).all()
    # Rotations are made orthonormal again.
    assert np.abs(again.poses - seen.poses).max() < 1e-15
    assert again.has_orientation.all() and again.has_orientation.dtype == bool
    assert set(again.targets) == {None} and set(again.sets) == {None} and again.ids == [] == again.files


def test_quaternions_are_poses_and_missing_ones_points():
    joints, positions = configurations(4), np.ones((4, 3))
    quaternions = np.array([[0, 0, 0, 1], [np.nan] * 4, [0.6, 0, 0, 0.8], [0, 0, 1, 0]])
    seen = poecal.Measurements.from_arrays(elbow(), joints=joints, positions=positions, quaternions_xyzw=quaternions)
    assert seen.has_orientation.tolist() == [True, False, True, True]
    assert np.allclose(seen.poses[3, :3, :3], np.diag([-1, -1, 1]))


def test_units_are_those_of_files(tmp_path):
    made = session("point")
    columns = table(made)
    path = tmp_path / "rows.csv"
    rows = zip(*columns.values(), strict=True)
    path.write_text(",".join(columns) + "\n" + "".join(",".join(repr(float(it)) for it in row) + "\n" for row in rows))
    of_file = poecal.Measurements.from_csv(path, elbow())
    numbers = np.column_stack(list(columns.values()))
    of_arrays = poecal.Measurements.from_arrays(
        elbow(), joints=numbers[:, :6], positions=numbers[:, 6:], angle_unit="deg", length_unit="mm"
    )
    for frame in [pandas.DataFrame(columns), polars.DataFrame(columns)]:
        of_frame = poecal.Measurements.from_dataframe(frame, elbow())
        assert (of_frame.joints == of_file.joints).all() and (of_frame.positions == of_file.positions).all()
    assert (of_arrays.joints == of_file.joints).all() and (of_arrays.positions == of_file.positions).all()
    assert of_file.files == [str(path)]


@pytest.mark.parametrize(
    "change",
    [
        lambda it: it.tolist(),
        lambda it: np.asfortranarray(it),
        lambda it: np.repeat(it, 2, axis=0)[::2],
        lambda it: it[::-1][::-1],
        lambda it: it.astype(">f8"),
        lambda it: pandas.DataFrame(it),
        lambda it: [list(row) for row in it],
        lambda it: it.astype(np.longdouble),
    ],
)
def test_any_array_will_do(change):
    made = session("point")
    joints, positions = made.measurements.joints, made.measurements.positions
    seen = poecal.Measurements.from_arrays(elbow(), joints=change(joints), positions=change(positions))
    assert (seen.joints == joints).all() and (seen.positions == positions).all()


def test_single_precision_and_integers_are_taken_as_they_are():
    joints = configurations(5).astype(np.float32)
    seen = poecal.Measurements.from_arrays(elbow(), joints=joints, positions=np.arange(15).reshape(5, 3))
    assert (seen.joints == joints.astype(float)).all()
    assert (elbow().forward_kinematics(joints) == elbow().forward_kinematics(joints.astype(float))).all()


def test_targets_sets_and_sigmas():
    seen = poecal.Measurements.from_arrays(
        elbow(),
        joints=configurations(4),
        positions=np.ones((4, 3)),
        targets=["a", "b", "a", "b"],
        sets=["fit", None, "held_out", "fit"],
        ids=["p", "q", "r", "s"],
        sigma_position_mm=[0.1, 0.2, np.nan, 0.1],
        sigma_rotation_deg=0.01,
    )
    assert seen.targets == ["a", "b", "a", "b"] and seen.ids == ["p", "q", "r", "s"]
    assert seen.sets == ["fit", None, "held_out", "fit"]
    assert "4 points of a, b" in repr(seen)


@pytest.mark.parametrize("library", [pandas, polars])
def test_data_frames_have_the_columns_of_files(library):
    made = session("point")
    columns = {name: values.tolist() for name, values in table(made).items()}
    columns |= {"target": ["ball, left"] * 50, "set": ["fit"] * 40 + ["held_out"] * 10, "run": list(range(50)), "id": [f"p{i}" for i in range(50)]}
    columns["sigma_position[mm]"] = [0.05] * 49 + [None]
    frame = library.DataFrame(columns)
    with pytest.warns(poecal.PoecalWarning, match="ignored the columns `run`"):
        seen = poecal.Measurements.from_dataframe(frame, elbow())
    assert set(seen.targets) == {"ball, left"} and seen.sets.count("held_out") == 10 and seen.ids[7] == "p7"
    assert seen.warnings == ["dataframe: ignored the columns `run`"]
    by_run = poecal.Measurements.from_dataframe(frame, elbow(), train_where="run=1,2,3")
    assert by_run.sets.count("fit") == 3
    assert set(poecal.Measurements.from_dataframe(frame, elbow(), ignore_sets=True).sets) == {None}


def test_data_frames_tell_the_row():
    columns = table(session("point"))
    frame = pandas.DataFrame(columns).astype(object)
    frame.loc[6, "y[mm]"] = "wrong"
    with pytest.raises(poecal.MeasurementError, match=r"^row 6: found `wrong` in column `y`") as raised:
        poecal.Measurements.from_dataframe(frame, elbow())
    assert (raised.value.row, raised.value.line) == (6, None)
    with pytest.raises(poecal.InputError, match="no column.*joint3"):
        poecal.Measurements.from_dataframe(pandas.DataFrame(columns).drop(columns="joint3[deg]"), elbow())
    with pytest.raises(poecal.OptionError, match="found list, expected a data frame"):
        poecal.Measurements.from_dataframe([1, 2], elbow())


def test_lost_beams_are_left_out_or_refused(tmp_path):
    frame = pandas.DataFrame(table(session()))
    axes = ["x[mm]", "y[mm]", "z[mm]"]
    frame.loc[3, axes], frame.loc[5, axes] = np.nan, 0.0
    words = "skipped 2 measurements with an empty or zero position, as of a lost beam"
    with pytest.warns(poecal.PoecalWarning, match=words):
        seen = poecal.Measurements.from_dataframe(frame, elbow())
    assert len(seen) == len(frame) - 2 and seen.warnings[0].endswith("; strict refuses them")
    with pytest.raises(poecal.MeasurementError, match="^row 3: found an empty position"):
        poecal.Measurements.from_dataframe(frame, elbow(), strict=True)
    path = tmp_path / "lost.csv"
    frame.to_csv(path, index=False)
    with pytest.warns(poecal.PoecalWarning, match=words):
        assert len(poecal.Measurements.from_csv(path, elbow())) == len(seen)
    with pytest.raises(poecal.MeasurementError, match="lost.csv:5:"):
        poecal.Measurements.from_csv(path, elbow(), strict=True)


def test_files_tell_line_and_column(tmp_path):
    path = tmp_path / "rows.csv"
    path.write_text(f"{HEADER},x,y,z\n1,2,3,4,5,6,1,1,1\n1,2,3,4,five,6,1,1,1\n")
    with pytest.raises(poecal.MeasurementError, match="rows.csv:3:9: found `five`") as raised:
        poecal.Measurements.from_csv(path, elbow())
    assert (raised.value.path, raised.value.line, raised.value.column, raised.value.row) == (str(path), 3, 9, None)
    again = pickle.loads(pickle.dumps(raised.value))
    assert (str(again), again.line) == (str(raised.value), 3)
    with pytest.raises(poecal.OptionError, match="named twice"):
        poecal.Measurements.from_csv([path, path], elbow())
    with pytest.raises(poecal.FileError, match="no such file"):
        poecal.Measurements.from_csv("nowhere.csv", elbow())


def test_joint_readings_of_a_file(tmp_path):
    path = tmp_path / "joints.csv"
    path.write_text(f"{HEADER}\n10,20,30,40,50,60\n1,2,3,4,5,6\n")
    found = poecal.read_joints(path, elbow())
    assert found.shape == (2, 6) and np.allclose(found[0], np.radians([10, 20, 30, 40, 50, 60]))


def test_copies_are_equal(tmp_path):
    for made in [session(), session("point"), session("mixed")]:
        seen = made.measurements
        for again in [pickle.loads(pickle.dumps(seen)), copy.copy(seen), copy.deepcopy(seen)]:
            assert again == seen and (again.poses == seen.poses).all()
    assert session().measurements != session(seed=2).measurements


def test_html_is_escaped():
    columns = table(session("point")) | {"target": ["<script>"] * 50}
    text = poecal.Measurements.from_dataframe(pandas.DataFrame(columns), elbow())._repr_html_()
    assert "<script>" not in text and "&lt;script&gt;" in text


def test_each_instrument_has_a_frame_of_its_own(tmp_path):
    made = session("point", count=80)
    seen = made.measurements
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    positions = np.vstack([seen.positions[:40], seen.positions[40:] @ turn.T + [1, 0, 0.5]])
    names = ["left"] * 40 + ["right"] * 40
    measured = poecal.Measurements.from_arrays(elbow(), joints=seen.joints, positions=positions, instruments=names)
    assert measured.instruments == names and pickle.loads(pickle.dumps(measured)) == measured
    calibration = poecal.calibrate(elbow(), measured)
    assert [it["instrument"] for it in calibration.stations] == ["left", "right"]
    assert calibration.accuracy.held_out.calibrated.position_mm.rms < 0.2

    files = [tmp_path / "monday.csv", tmp_path / "tuesday.csv"]
    header = ",".join(f"joint{i}" for i in range(1, 7)) + ",x,y,z\n"
    for path, rows in zip(files, np.split(np.hstack([seen.joints, positions]), 2), strict=True):
        path.write_text(header + "".join(",".join(repr(float(it)) for it in row) + "\n" for row in rows))
    of_files = poecal.Measurements.from_csv(files, elbow(), device_frames="per-file")
    assert of_files.instruments == [str(files[0])] * 40 + [str(files[1])] * 40
    assert poecal.calibrate(elbow(), of_files).accuracy == calibration.accuracy


ROOT = Path(__file__).resolve().parents[3]
FILES = [path for folder in ("fuzz/seeds/measurements", "fuzz/seeds/recorded", "examples/elbow", "examples/howto") for path in sorted((ROOT / folder).iterdir()) if path.is_file()]


def understood(read):
    """The rows that are read, with their warnings, or the error."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            found = read()
            rows = [found.joints.tolist(), found.positions.tolist()]
        except poecal.Error as error:
            rows = [type(error).__name__, str(error)]
    return rows, [str(it.message) for it in said]


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}-{path.name}")
def test_contents_are_read_as_their_file(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    content = path.read_bytes()
    Path(path.name).write_bytes(content)
    robot = poecal.Robot.read(ROOT / "examples/elbow/robot.urdf")
    of_file = understood(lambda: poecal.Measurements.from_files(path.name, robot))
    Path(path.name).unlink()
    assert understood(lambda: poecal.Measurements.from_contents({path.name: content}, robot)) == of_file
    try:
        text = content.decode()
    except UnicodeDecodeError:
        return
    assert understood(lambda: poecal.Measurements.from_contents({path.name: text}, robot)) == of_file


def test_contents_of_two_files_are_joined_and_others_are_refused():
    folder = ROOT / "examples/howto"
    names = ["joints.csv", "take.csv"]
    robot = poecal.Robot.read(ROOT / "examples/elbow/robot.urdf")
    joined = poecal.Measurements.from_contents({name: (folder / name).read_bytes() for name in names}, robot)
    assert len(joined) == len(poecal.Measurements.from_files([folder / name for name in names], robot)) > 0
    for contents, words in [({"a.csv": 3}, "contents: found a int for `a.csv`"), ({1: "x"}, "contents: found a name that is no text"), ({}, "found no measurement file")]:
        with pytest.raises(poecal.Error, match=words):
            poecal.Measurements.from_contents(contents, elbow())
