"""Each fault is reported in a sentence, and no panic reaches Python."""

import itertools
import random
from pathlib import Path

import numpy as np
import poecal
import pytest
from robots import ELBOW, configurations, elbow, session

# Warnings of fits of odd rows are not tested here.
pytestmark = pytest.mark.filterwarnings("ignore::poecal.PoecalWarning")

JOINTS, POSITIONS = configurations(20), np.ones((20, 3))
SEEN = session(count=20).measurements


def arrays(**change):
    return poecal.Measurements.from_arrays(elbow(), **({"joints": JOINTS, "positions": POSITIONS} | change))


def calibrate(**options):
    return poecal.calibrate(elbow(), SEEN, **options)


def screws(change):
    numbers = elbow().screws
    change(numbers)
    return poecal.Robot.from_screws(numbers, elbow().home)


SENTENCES = [
    (lambda: arrays(joints=JOINTS[:, :5]), "joints: found an array of shape (20, 5), expected shape (m, 6): in each row joint1, joint2, joint3, joint4, joint5, joint6"),
    (lambda: arrays(joints=JOINTS[0]), "joints: found an array of shape (6,), expected shape (m, 6): in each row joint1, joint2, joint3, joint4, joint5, joint6"),
    (lambda: arrays(positions=POSITIONS[1:]), "positions: found an array of shape (19, 3), expected shape (20, 3): a position for each row of joints"),
    (lambda: arrays(positions=None), "positions: found neither positions nor poses, expected one of the two"),
    (lambda: arrays(poses=np.tile(np.eye(4), (20, 1, 1))), "poses: found both positions and poses, expected one of the two"),
    (lambda: arrays(positions=None, poses=np.zeros((20, 4, 4))), "poses: row 0: found the last row [0.0, 0.0, 0.0, 0.0], expected 0, 0, 0, 1"),
    (lambda: arrays(positions=None, poses=np.tile(np.diag([1, 1, -1, 1]), (20, 1, 1))), "poses: row 0: found a matrix whose upper left part is no rotation (RᵀR is 0.0e0 from the identity, determinant -1.0000), expected one"),
    (lambda: arrays(quaternions_xyzw=np.ones((20, 4))), "quaternions_xyzw: row 0: found a quaternion of norm 2.0000, expected 1 to within 0.01"),
    (lambda: arrays(joints=np.where(JOINTS == JOINTS[3, 2], np.nan, JOINTS)), "joints: found NaN in row 3, expected finite numbers"),
    (lambda: arrays(joints=JOINTS * 1j), "joints: found values of type complex128, expected shape (m, 6): in each row joint1, joint2, joint3, joint4, joint5, joint6"),
    (lambda: arrays(joints=None), "joints: found None, expected shape (m, 6): in each row joint1, joint2, joint3, joint4, joint5, joint6"),
    (lambda: arrays(joints="joints.csv"), "joints: found values of type <U10, expected shape (m, 6): in each row joint1, joint2, joint3, joint4, joint5, joint6"),
    (lambda: arrays(joints=JOINTS * 0 + 2e9), "joints: row 0: found 2e9 (metres or radians), expected at most 1e6: correct the number or the unit"),
    (lambda: arrays(targets=["a"]), "targets: found 1 entries, expected 20, one for each row of joints"),
    (lambda: arrays(sets=["train"] * 20), "sets: found `train`, expected one of fit, held_out"),
    (lambda: arrays(sigma_position_mm=-1), "sigma_position_mm: row 0: found -1, expected a standard deviation above 0"),
    (lambda: arrays(length_unit="ft"), "length_unit: found the unit `ft`, expected a length (m, cm, mm, um, nm, in)"),
    (lambda: arrays(joints=np.empty((0, 6)), positions=np.empty((0, 3))), "joints: found no row, expected at least one measurement"),
    (lambda: calibrate(device_frame="tool"), "device_frame: found `tool`, expected one of unknown, base"),
    (lambda: calibrate(robust="hubre"), "robust: found `hubre`, expected one of auto, off, huber, cauchy, tukey; did you mean `huber`?"),
    (lambda: calibrate(held_out=1.5), "found a held-out share of 1.5, expected a number from 0 to below 1"),
    (lambda: calibrate(sigma_position_mm=0), "sigma_position_mm: found 0, expected a standard deviation above 0"),
    (lambda: calibrate(sigma_rotation_deg=float("nan")), "sigma_rotation_deg: found NaN, expected a standard deviation above 0"),
    (lambda: poecal.simulate(elbow(), count=0), "count: found 0, expected 1 to 10000000"),
    (lambda: poecal.simulate(elbow(), noise_position_mm=float("inf")), "noise_position_mm: found inf, expected a finite number not below 0"),
    (lambda: elbow().forward_kinematics([1, 2]), "joints: found an array of shape (2,), expected shape (m, 6) or (6,): in each configuration joint1, joint2, joint3, joint4, joint5, joint6 (radians; metres of sliding joints)"),
    (lambda: elbow().forward_kinematics(JOINTS, target="ball"), "elbow: found no target `ball`, expected none: the model has no targets, leave out target to predict the tip"),
    (lambda: elbow().to_text("xml"), "format: found `xml`, expected one of urdf, toml"),
    (lambda: elbow().write("robot.step"), "format: found no form in the name `robot.step`, expected .urdf or .toml, or format=\"urdf\" or \"toml\""),
    (lambda: poecal.Robot.from_dh(**(ELBOW | {"d_m": [0]})), "d_m: found an array of shape (1,), expected shape (6,) as a_m"),
    (lambda: poecal.Robot.from_dh(**ELBOW, names=["a"] * 6), "found a second joint named `a`, expected unique joint names"),
    (lambda: poecal.Robot.from_dh(**ELBOW, convention="craig"), "convention: found `craig`, expected one of standard, modified"),
    (lambda: poecal.Robot.from_screws(np.eye(6)[:, :5], np.eye(4)), "screws: found an array of shape (6, 5), expected shape (n, 6): a unit twist a joint"),
    (lambda: poecal.Robot.from_screws(elbow().screws, np.eye(3)), "home: found an array of shape (3, 3), expected a pose of shape (4, 4)"),
    (lambda: poecal.Robot.read("nowhere.urdf"), "nowhere.urdf: found no such file, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json): check the path"),
    (lambda: poecal.calibrate(poecal.Robot.from_dh(**ELBOW, names=list("abcdef")), SEEN), "measurements: found readings of joint1, joint2, joint3, joint4, joint5, joint6, expected those of robot `robot`: a, b, c, d, e, f"),
    (lambda: poecal.calibrate(elbow(), arrays(joints=JOINTS[:2], positions=POSITIONS[:2])), None),
    (lambda: screws(lambda it: it.__setitem__((2, 3), 5.0)), None),
    (lambda: poecal.reproduce("lou2010"), "experiment: found `lou2010`, expected one of lou2009, breakdown; did you mean `lou2009`?"),
    (lambda: calibrate().predict(JOINTS, target="ball"), "calibration.json: found no target `ball`, expected one of measured"),
    (lambda: calibrate(validate=SEEN[:0]), "validate: found no rows, expected at least one that judges the fit"),
    (lambda: calibrate(seed=-1), "seed: found -1, expected a whole number from 0 to 18446744073709551615"),
    (lambda: calibrate(seed=2**70), "seed: found 1180591620717411303424, expected a whole number from 0 to 18446744073709551615"),
    (lambda: calibrate(seed=1.5), "seed: found 1.5, expected a whole number from 0 to 18446744073709551615"),
    (lambda: calibrate(seed=np.int64(-3)), "seed: found -3, expected a whole number from 0 to 18446744073709551615"),
    (lambda: calibrate(held_out="0.3"), "held_out: found the text `0.3`, expected a number"),
    (lambda: calibrate(device_frame=3), "device_frame: found 3, expected a text"),
    (lambda: calibrate(tolerance_deg_mm=5), "tolerance_deg_mm: found 5, expected two numbers"),
    (lambda: calibrate(progress=5), "progress: found 5, expected a function of one text, or True for a bar"),
    (lambda: poecal.calibrate("robot.urdf", SEEN), "robot.urdf: found no such file, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json): check the path"),
    (lambda: poecal.calibrate(5, SEEN), "robot: found 5, expected a poecal.Robot; poecal.Robot.read reads one from a file"),
    (lambda: poecal.calibrate(elbow(), "no.csv"), "no.csv: found no such file, expected a measurement file (CSV): check the path"),
    (lambda: poecal.calibrate(elbow(), [SEEN]), "measurements: found list, expected poecal.Measurements, as of Measurements.from_csv, from_arrays or from_dataframe"),
    (lambda: poecal.simulate(elbow(), count=2.0), "count: found 2.0, expected a whole number from 0 to 18446744073709551615"),
    (lambda: poecal.Robot.read(5), "path: found 5, expected a path: a text, or an os.PathLike"),
    (lambda: poecal.Robot.read(None), "path: found None, expected a path: a text, or an os.PathLike"),
    (lambda: poecal.Robot.read(""), "path: found an empty text, expected a path"),
    (lambda: poecal.Robot.read(elbow().to_text("urdf")), "path: found the text `<?xml version=\"1.0\"?>…`, expected the path of a file that holds it; a robot model's text is read by poecal.Robot.from_text"),
    (lambda: poecal.Robot.read("<robot name='a'/>"), "path: found the text `<robot name='a'/>`, expected the path of a file that holds it; a robot model's text is read by poecal.Robot.from_text"),
    (lambda: poecal.Robot.read(Path(__file__).parent), f"{Path(__file__).parent}: found a directory, expected a robot model (URDF, MJCF, SDF, TOML or calibration.json)"),
    (lambda: poecal.Robot.from_text("robot.urdf"), "text: found `robot.urdf`, expected the text of a model; poecal.Robot.read reads a file"),
    (lambda: poecal.Measurements.from_csv(5, elbow()), "paths: found 5, expected a path, or a list of paths"),
    (lambda: poecal.Measurements.from_csv(["a.csv", 5], elbow()), "paths[1]: found 5, expected a path: a text, or an os.PathLike"),
    (lambda: poecal.Measurements.join([SEEN, 3]), "parts[1]: found 3, expected poecal.Measurements, as of Measurements.from_csv, from_arrays or from_dataframe"),
    (lambda: poecal.Measurements.join([]), "parts: found none, expected at least one"),
    (lambda: SEEN[20], "rows: found 20, expected a row from 0 to 19, or from -20 to -1"),
    (lambda: SEEN[[0, -21]], "rows: found -21, expected a row from 0 to 19, or from -20 to -1"),
    (lambda: SEEN[:0][0], "rows: found 0, expected none, since there are no rows"),
    (lambda: SEEN[[True] * 3], "rows: found a mask of 3 entries, expected 20, one for each row"),
    (lambda: SEEN["id"], "rows: found the text `id`, expected a slice, a row, a list of rows, or a True or False for each row"),
    (lambda: SEEN[1.5], "rows: found 1.5, expected a slice, a row, a list of rows, or a True or False for each row"),
    (lambda: arrays(targets="ball"), "targets: found the text `ball`, expected a list"),
    (lambda: arrays(ids=range(20)), "ids[0]: found 0, expected a text"),
    (lambda: arrays(joints=np.ma.masked_equal(JOINTS, JOINTS[3, 2])), "joints: found a masked number, or NaN, in row 3, expected finite numbers: leave such rows out"),
    (lambda: arrays(positions=np.ma.masked_all((20, 3))), "positions: found a masked number, or NaN, in row 0, expected finite numbers: leave such rows out"),
    (lambda: poecal.export(elbow(), offset={"joint1": "0.1"}, format="toml"), "offset[\"joint1\"]: found the text `0.1`, expected a number, or a text of one with its unit, like \"0.05deg\""),
    (lambda: poecal.export(elbow(), offset=[0.1], format="toml"), "offset: found list, expected a dict of names and numbers"),
    (lambda: poecal.offsets(elbow(), 5), "actual: found 5, expected a poecal.Robot or a poecal.Calibration"),
    (lambda: calibrate().predict(JOINTS, with_uncertainty="yes"), "with_uncertainty: found the text `yes`, expected True or False"),
    (lambda: calibrate().write(5), "folder: found 5, expected a path: a text, or an os.PathLike"),
    (lambda: calibrate().write("out", report=5), "report: found 5, expected True, False, or the path of a file"),
    (lambda: calibrate().plot([1, 2]), "axes: found list, expected two axes of matplotlib, as of plt.subplots(1, 2)"),
    (lambda: poecal.set_threads("4"), "count: found the text `4`, expected a whole number from 0 to 18446744073709551615"),
    (lambda: calibrate().verdict.is_at_least("perfect"), "level: found `perfect`, expected one of good, inside_sampled_range, measured_configurations, located, do_not_use"),
]  # fmt: skip


@pytest.mark.parametrize("number", range(len(SENTENCES)))
def test_a_mistake_is_one_sentence(number):
    mistake, sentence = SENTENCES[number]
    with pytest.raises(poecal.Error) as raised:
        mistake()
    print(raised.value)
    assert sentence is None or str(raised.value) == sentence


def test_errors_are_a_tree():
    assert issubclass(poecal.InputError, ValueError) and issubclass(poecal.InputError, poecal.Error)
    for name in ["FileError", "FormatError", "ModelError", "MeasurementError", "UnitError", "OptionError"]:
        assert issubclass(getattr(poecal, name), poecal.InputError)
    for name in ["ProblemError", "ExportError", "SolverError"]:
        assert issubclass(getattr(poecal, name), poecal.Error)
    with pytest.raises(poecal.ProblemError):
        poecal.calibrate(elbow(), arrays(joints=JOINTS[:2], positions=POSITIONS[:2]))


def test_arguments_that_do_not_exist_are_type_errors():
    with pytest.raises(TypeError):
        poecal.calibrate(elbow(), SEEN, "base")
    with pytest.raises(TypeError):
        poecal.calibrate(elbow(), SEEN, sead=1)
    with pytest.raises(TypeError):
        poecal.calibrate(elbow())
    with pytest.raises(TypeError):
        SEEN + 1


ODD = [
    None, True, 0, -1, 1e300, float("nan"), float("inf"), 2**70, "", "text", b"bytes", [], [[]], {}, {"a": 1}, object(), 1j, [1, "a"], [[1], [2, 3]],
    np.nan * np.ones((20, 6)), np.full((20, 6), 1e200), np.full((20, 6), 1e308), np.full((20, 3), 1e200), np.zeros((20, 6)), np.zeros((20, 3)),
    np.zeros((20, 4)), np.zeros((20, 4, 4)), np.tile(np.eye(4), (20, 1, 1)), np.ones((1, 6)), np.ones(6), np.ones((6, 20)).T, np.ones((2, 2, 2, 2)),
    np.empty((0, 6)), np.empty((20, 0)), np.array("a"), np.array([None] * 20), np.array([[1, 2]], dtype="m8[s]"), np.ones((20, 6), bool),
    np.ones((20, 6), np.float16), np.ones((20, 6), complex), JOINTS, JOINTS[::2], POSITIONS, np.float64(3), np.ma.masked_all((20, 6)), elbow(), SEEN,
    range(20), iter([1]), "unknown", "base", ["a"] * 20, [None] * 20, np.full((20, 6), 5e-324), slice(3), type, Exception("x"),
]  # fmt: skip
TABLE = {f"joint{i + 1}": JOINTS[:, i] for i in range(6)} | {axis: POSITIONS[:, i] for i, axis in enumerate("xyz")}
CALLS = {
    "arrays": (lambda **it: poecal.Measurements.from_arrays(elbow(), **it), ["joints", "positions", "quaternions_xyzw", "poses", "targets", "sets", "ids", "sigma_position_mm", "sigma_rotation_deg", "angle_unit", "length_unit"], {"joints": JOINTS, "positions": POSITIONS}),
    "dh": (poecal.Robot.from_dh, ["a_m", "alpha_rad", "d_m", "theta_rad", "convention", "kinds", "names", "limits", "base", "tool", "name", "base_link"], ELBOW),
    "screws": (poecal.Robot.from_screws, ["screws", "home", "names", "limits", "angular_first", "name", "tip_link"], {"screws": elbow().screws, "home": np.eye(4)}),
    "calibrate": (poecal.calibrate, ["measurements", "device_frame", "sigma_position_mm", "sigma_rotation_deg", "held_out", "seed", "robust", "formulation", "residual", "method", "validate", "progress"], {"robot": elbow(), "measurements": SEEN}),
    "identify": (poecal.identify, ["joints", "kind", "sigma_position_mm", "sigma_rotation_deg", "device_frame"], {"robot": elbow(), "joints": JOINTS}),
    "kinematics": (elbow().forward_kinematics, ["joints", "target"], {"joints": JOINTS}),
    "predict": (poecal.calibrate(elbow(), SEEN).predict, ["joints", "with_uncertainty", "output_frame", "target"], {"joints": JOINTS}),
    "to_text": (elbow().to_text, ["format"], {"format": "toml"}),
    "offsets": (poecal.offsets, ["actual", "base", "tip"], {"nominal": elbow(), "actual": elbow()}),
    "frame": (lambda **it: poecal.Measurements.from_dataframe(robot=elbow(), **it), ["frame", "columns", "train_where"], {"frame": TABLE}),
    "rows": (lambda rows: SEEN[rows], ["rows"], {}),
    "join": (poecal.Measurements.join, ["parts"], {}),
    "files": (lambda **it: poecal.Measurements.from_csv(robot=elbow(), **it), ["paths", "columns", "train_where", "ignore_sets", "strict", "device_frames"], {"paths": "nowhere.csv"}),
    "model": (poecal.Robot.read, ["path", "base_link", "tip_link"], {"path": "nowhere.urdf"}),
    "text": (poecal.Robot.from_text, ["text", "base_link", "tip_link"], {"text": elbow().to_text("toml")}),
    "results": (poecal.Calibration.read, ["path", "residuals"], {"path": "nowhere.json"}),
    "plot": (poecal.calibrate(elbow(), SEEN).plot, ["axes"], {}),
    "check": (poecal.check, ["robot", "measurements", "device_frame"], {"robot": elbow()}),
    "validate": (poecal.calibrate(elbow(), SEEN).validate, ["measurements", "refit", "force", "record"], {"measurements": SEEN}),
    "readings": (poecal.read_joints, ["path", "robot", "columns"], {"path": "nowhere.csv", "robot": elbow()}),
    "simulate": (poecal.simulate, ["kind", "seed", "error_position_mm", "error_rotation_deg", "noise_position_mm", "noise_rotation_deg", "device_frame"], {"robot": elbow(), "count": 3}),
}  # fmt: skip


@pytest.mark.parametrize("name", CALLS)
def test_odd_arguments_are_refused_without_a_panic(name):
    """Each argument with each odd value, and pairs at random: an exception of poecal, or a result."""
    call, arguments, usual = CALLS[name]
    pairs = list(itertools.product(arguments, ODD))
    changes = [{argument: value} for argument, value in pairs]
    chance = random.Random(1)
    changes += [dict(chance.sample(pairs, 2)) for _ in range(150)]
    refused = 0
    for change in changes:
        try:
            call(**(usual | change))
        except poecal.Error as error:
            refused += 1
            assert str(error) and not hasattr(error, "__notes__")
    print(f"{refused} of {len(changes)} refused")
    assert refused


@pytest.mark.parametrize("scale", [1e3, 1e5, 1e7, 1e100, 1e300])
def test_numbers_that_are_too_large_do_no_harm(scale):
    positions = configurations(20)[:, :3] * scale
    try:
        measured = arrays(positions=positions)
    except poecal.InputError as error:
        limit = "expected at most 1e6: correct the number or the unit" if scale >= 1e6 else 'if they are millimetres, write length_unit="mm"'
        assert limit in str(error)
    else:
        poecal.calibrate(elbow(), measured).to_json()


def test_degrees_and_millimetres_are_no_radians_and_metres():
    joints = configurations(20)
    with pytest.raises(poecal.OptionError, match=r'joints: found .* rad of .*: if they are degrees, write angle_unit="deg"'):
        arrays(joints=joints * 180 / 3.14159)
    with pytest.raises(poecal.OptionError, match=r'positions: found positions that spread over .*: if they are millimetres, write length_unit="mm"'):
        arrays(positions=1e3 * joints[:, :3])
