"""Rows of measurements: chosen, joined, one by one; and arrays that have masks or cannot be written to."""

import copy
import pickle

import numpy as np
import poecal
import pytest
from robots import configurations, elbow, session

TOLD = {
    "targets": ["a", "b"] * 5,
    "instruments": ["left"] * 5 + ["right"] * 5,
    "sets": ["fit"] * 8 + ["held_out"] * 2,
    "ids": [f"p{row}" for row in range(10)],
    "sigma_position_mm": np.arange(1.0, 11.0),
}


def measured(**change) -> poecal.Measurements:
    positions = np.random.default_rng(2).uniform(-1, 1, (10, 3))
    return poecal.Measurements.from_arrays(elbow(), joints=configurations(10), positions=positions, **(TOLD | change))


@pytest.mark.parametrize(
    ("key", "rows"),
    [
        (slice(None), range(10)),
        (slice(2, 5), range(2, 5)),
        (slice(None, None, -3), [9, 6, 3, 0]),
        (slice(-2, 100), [8, 9]),
        (slice(5, 2), []),
        (3, [3]),
        (-1, [9]),
        (np.int64(4), [4]),
        ([1, 5, -1, 5], [1, 5, 9, 5]),
        ((0, 1), [0, 1]),
        (np.array([7, 2]), [7, 2]),
        ([], []),
        ([True, False] * 5, range(0, 10, 2)),
        (np.arange(10) > 6, [7, 8, 9]),
        (np.zeros(10, bool), []),
    ],
)
def test_chosen_rows_keep_what_is_known_of_them(key, rows):
    whole, rows = measured(), list(rows)
    part = whole[key]
    assert len(part) == len(rows)
    assert (part.joints == whole.joints[rows]).all() and (part.positions == whole.positions[rows]).all()
    for name in ["targets", "instruments", "sets", "ids"]:
        assert getattr(part, name) == [getattr(whole, name)[row] for row in rows], name
    assert pickle.loads(pickle.dumps(part)) == part == copy.copy(part)


def test_all_rows_are_the_whole():
    whole = measured()
    assert whole[:] == whole == whole[np.ones(10, bool)] == whole[range(10)]
    assert whole[:4] + whole[4:] == whole == poecal.Measurements.join([whole[:3], whole[3:5], whole[5:]])
    assert whole[::-1] != whole and whole[::-1][::-1] == whole
    assert repr(whole[2]) == "<poecal.Measurements 1 row: 1 point of a>"
    assert repr(whole[:0]) == "<poecal.Measurements 0 rows>"


def test_rows_come_one_by_one():
    whole = measured()
    assert [row.ids for row in whole] == [[name] for name in whole.ids]
    assert poecal.Measurements.join(list(whole)) == whole
    with pytest.raises(IndexError):
        whole[10]
    assert issubclass(poecal.RowError, poecal.OptionError)


def test_chosen_rows_of_files_know_their_lines(tmp_path):
    made = session("point")
    paths = [tmp_path / "a.csv", tmp_path / "b.csv"]
    header = ",".join(f"joint{i}" for i in range(1, 7)) + ",x,y,z\n"
    numbers = np.hstack([made.measurements.joints, made.measurements.positions])
    for path, rows in zip(paths, [numbers[:20], numbers[20:]], strict=True):
        path.write_text(header + "".join(",".join(repr(float(it)) for it in row) + "\n" for row in rows))
    whole = poecal.Measurements.from_csv(paths, elbow())
    part = whole[[30, 2, 40]]
    assert part.files == [str(paths[1]), str(paths[0])] and whole[25:].files == [str(paths[1])]
    assert whole[:30] + whole[30:] == whole
    each = [poecal.Measurements.from_csv(path, elbow()) for path in paths]
    assert each[0] + each[1] == whole
    calibration = poecal.calibrate(elbow(), whole[::-1])
    residuals = calibration.residuals
    assert residuals.files == [str(paths[1])] * 30 + [str(paths[0])] * 20
    assert residuals.lines.tolist() == [*range(31, 1, -1), *range(21, 1, -1)]
    assert calibration.to_dict()["inputs"]["measurements"] == [str(path) for path in paths]


def test_a_fit_of_chosen_rows_is_that_of_the_same_rows():
    made = session("point", count=60).measurements
    plain = poecal.Measurements.from_arrays(elbow(), joints=made.joints[:40], positions=made.positions[:40])
    ours, theirs = (poecal.calibrate(elbow(), it) for it in [made[:40], plain])
    assert ours.accuracy.held_out == theirs.accuracy.held_out
    assert poecal.calibrate(elbow(), made[:40], validate=made[40:]).accuracy.held_out.count == 20


def test_joined_rows_share_targets_and_instruments_of_one_name():
    left, right = measured(instruments=["left"] * 10), measured(instruments=["right"] * 10)
    both = left + right
    assert both.instruments == ["left"] * 10 + ["right"] * 10 and both.targets == ["a", "b"] * 10
    unnamed = measured(instruments=None, ids=None, targets=None, sets=None, sigma_position_mm=None)
    mixed = left + unnamed
    assert mixed.instruments == ["left"] * 10 + [None] * 10 and mixed.ids == [*TOLD["ids"], *[""] * 10]
    assert mixed.targets == TOLD["targets"] + [None] * 10 and mixed.sets == TOLD["sets"] + [None] * 10
    assert (mixed[10:].joints == unnamed.joints).all() and mixed[10:].instruments == [None] * 10
    assert (unnamed + unnamed).instruments == [None] * 20


def test_other_joints_are_not_joined():
    other = poecal.Robot.from_dh(a_m=[0.3], alpha_rad=[0], d_m=[0], theta_rad=[0], names=["slide"], kinds=["prismatic"])
    rows = poecal.Measurements.from_arrays(other, joints=[[0.1]], positions=[[1, 2, 3]])
    with pytest.raises(poecal.OptionError, match=r"^parts\[1\]: found readings of slide, expected those of the first: joint1, "):
        measured() + rows
    with pytest.raises(TypeError):
        measured() + [1]


def test_no_rows_are_refused_where_some_are_needed():
    none = session().measurements[:0]
    with pytest.raises(poecal.ProblemError):
        poecal.calibrate(elbow(), none)
    with pytest.raises(poecal.ProblemError):
        poecal.calibrate(elbow(), session().measurements).validate(none)
    assert poecal.check(elbow(), none)["diagnosis"] == []


def test_arrays_that_cannot_be_written_to_are_read():
    made = session()
    frozen = [made.measurements.joints, made.measurements.poses]
    for array in frozen:
        array.flags.writeable = False
    seen = poecal.Measurements.from_arrays(elbow(), joints=frozen[0], poses=frozen[1])
    assert (seen.joints == frozen[0]).all()
    assert elbow().forward_kinematics(frozen[0]).shape == (50, 4, 4)
    assert len(seen[np.broadcast_to(np.True_, 50)]) == 50


def test_arrays_are_copies():
    seen = session().measurements
    seen.joints[:] = 0
    assert seen.joints.any() and seen.joints.flags.writeable


def test_masks_are_missing_orientations_deviations_and_limits():
    joints, positions = configurations(4), np.ones((4, 3))
    quaternions = np.ma.masked_array(np.tile([0.0, 0, 0, 1], (4, 1)), mask=False)
    quaternions[1] = np.ma.masked
    sigma = np.ma.masked_array([0.1, 0.2, 0.3, 0.4], mask=[0, 0, 0, 1])
    seen, plain = (
        poecal.Measurements.from_arrays(elbow(), joints=joints, positions=positions, quaternions_xyzw=quaternion, sigma_position_mm=of_row)
        for quaternion, of_row in [(quaternions, sigma), (quaternions.filled(np.nan), sigma.filled(np.nan))]
    )
    assert seen == plain and seen.has_orientation.tolist() == [True, False, True, True]
    limits = np.ma.masked_array(np.tile([-1.0, 1.0], (6, 1)), mask=False)
    limits[2] = np.ma.masked
    robot = poecal.Robot.from_screws(elbow().screws, elbow().home, limits=limits)
    assert robot.limits[2].tolist() == [-np.inf, np.inf] and robot.limits[3].tolist() == [-1, 1]


@pytest.mark.parametrize("change", [lambda it: it, list, lambda it: it.copy(order="F"), lambda it: it.astype(np.float32)])
def test_masks_without_effect_change_nothing(change):
    joints = np.ma.masked_array(configurations(4).astype(np.float32).astype(float), mask=False)
    seen = poecal.Measurements.from_arrays(elbow(), joints=change(joints), positions=np.ma.ones((4, 3), dtype=int))
    assert (seen.joints == joints.data).all()
    joints[2, 1] = np.ma.masked
    with pytest.raises(poecal.OptionError, match="joints: found a masked number, or NaN, in row 2"):
        poecal.Measurements.from_arrays(elbow(), joints=change(joints), positions=np.ones((4, 3)))
    with pytest.raises(poecal.OptionError, match="joints: found a masked number, or NaN, in row 2"):
        elbow().forward_kinematics(change(joints))
