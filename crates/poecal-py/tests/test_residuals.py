"""Residuals of rows, covariance of unknowns, and the picture of both: the contents of the files, as arrays."""

import io
import pickle
import subprocess
import sys

import matplotlib
import numpy as np
import pandas
import poecal
import pytest
from robots import configurations, elbow, session
from test_robot import exponential, hat

matplotlib.use("Agg")
DIAGNOSTICS = ["weight", "leverage", "studentized", "suspected"]


def calibrated(kind: str, **options) -> poecal.Calibration:
    made = session(kind, count=80, device_frame=options.get("device_frame", "unknown"))
    return poecal.calibrate(made.nominal, made.measurements, **options)


@pytest.fixture(scope="module")
def calibrations() -> dict[str, poecal.Calibration]:
    return {kind: calibrated(kind) for kind in ["pose", "point", "mixed"]}


@pytest.mark.parametrize("kind", ["pose", "point", "mixed"])
def test_residuals_are_those_of_the_file(calibrations, kind):
    calibration = calibrations[kind]
    frame = calibration.residuals.to_dataframe()
    of_file = pandas.read_csv(io.StringIO(calibration.residuals_csv()))
    assert list(frame) == list(of_file) and len(frame) == len(of_file) == len(calibration.residuals) == 80
    for name in frame:
        if of_file[name].dtype.kind in "fi" and frame[name].dtype.kind in "fiub":
            # Numbers in files are rounded.
            assert np.allclose(frame[name].astype(float), of_file[name].astype(float), rtol=1e-6, atol=1e-9, equal_nan=True), name
        else:
            texts = [table[name].astype(object).where(table[name].notna(), "").tolist() for table in [frame, of_file]]
            assert texts[0] == texts[1], name
    assert calibration.residuals.to_polars().columns == list(frame)


def test_arrays_of_residuals_fit_together(calibrations):
    calibration = calibrations["mixed"]
    residuals = calibration.residuals
    assert np.allclose(np.linalg.norm(residuals.position_mm, axis=1), residuals.errors("position"))
    seen = residuals.rotation_calibrated_deg[~np.isnan(residuals.rotation_calibrated_deg)]
    assert len(seen) == 40 and np.isnan(residuals.rotation_deg).any(axis=1).sum() == 40
    of_set = calibration.accuracy.held_out
    assert residuals.held_out.sum() == of_set.count
    for model in ["nominal", "registered", "calibrated"]:
        errors = getattr(residuals, f"position_{model}_mm")[residuals.held_out]
        assert np.isclose(np.sqrt((errors**2).mean()), getattr(of_set, model).position_mm.rms)
    # By the names of quantities the same, and in the order by which a calibration is judged.
    assert list(residuals.quantities.items()) == [("position", "mm"), ("rotation", "deg")]
    for quantity, unit in residuals.quantities.items():
        assert np.array_equal(residuals.components(quantity), getattr(residuals, f"{quantity}_{unit}"), equal_nan=True)
        assert np.array_equal(residuals.errors(quantity), getattr(residuals, f"{quantity}_calibrated_{unit}"), equal_nan=True)
        nominal = residuals.errors(quantity, model="nominal")
        assert np.array_equal(nominal, getattr(residuals, f"{quantity}_nominal_{unit}"), equal_nan=True)
    assert list(calibrations["point"].residuals.quantities) == ["position"]
    with pytest.raises(poecal.OptionError, match="quantity: found `positon`, expected one of position, rotation, distance, contact, height, tilt; did you mean `position`"):
        residuals.components("positon")
    with pytest.raises(poecal.OptionError, match="model: found `best`, expected one of delivered, nominal, registered, calibrated, corrected"):
        residuals.errors("position", model="best")
    for name in DIAGNOSTICS:
        assert getattr(residuals, name).shape == (80,)
    assert residuals.suspected.dtype == bool and not residuals.suspected.any()
    assert (residuals.weight > 0.5).all()
    assert repr(residuals) == "<poecal.Residuals of 80 rows, 24 held out>"


def test_names_of_rows_are_those_of_the_measurements():
    seen = session("point", count=60).measurements
    names = {
        "targets": ["ball", "cup"] * 30,
        "instruments": ["left"] * 60,
        "ids": [f"p{row}" for row in range(60)],
    }
    rows = poecal.Measurements.from_arrays(elbow(), joints=seen.joints, positions=seen.positions, **names)
    residuals = poecal.calibrate(elbow(), rows).residuals
    assert residuals.targets == names["targets"] and residuals.ids == names["ids"]
    assert residuals.files == [None] * 60 and residuals.lines.tolist() == [0] * 60


def test_residuals_that_are_not_there_are_an_error(calibrations, tmp_path):
    calibrations["point"].write(tmp_path / "out")
    again = poecal.Calibration.read(tmp_path / "out/calibration.json")
    assert (again.residuals.lines == calibrations["point"].residuals.lines).all()
    (tmp_path / "out/residuals.csv").unlink()
    with pytest.raises(poecal.OptionError, match="found no residuals.csv beside the calibration.json"):
        poecal.Calibration.read(tmp_path / "out/calibration.json").residuals  # noqa: B018


def moved(calibration, name, step) -> poecal.Robot:
    """The calibrated robot with one unknown changed, by the book (docs/theory.md §5 (18))."""
    robot, covariance = calibration.robot, calibration.covariance
    group, _, motion = name.replace(".axis.", ".").rpartition(".")
    twist = np.zeros(6)
    twist["xyz".index(motion[-1]) + (3 if motion.startswith("r") else 0)] = step
    screws, home = robot.screws, robot.home
    if group in robot.joint_names:
        joint = robot.joint_names.index(group)
        axis = covariance.axes[joint]
        change = axis @ exponential(hat(twist)) @ np.linalg.inv(axis)
        turned = change @ hat(screws[joint]) @ np.linalg.inv(change)
        screws[joint] = [*turned[:3, 3], turned[2, 1], turned[0, 2], turned[1, 0]]
    else:
        home = home @ exponential(hat(twist))
    return poecal.Robot.from_screws(screws, home)


@pytest.mark.parametrize("kind", ["pose", "point"])
@pytest.mark.parametrize("frame", ["unknown", "base"])
def test_the_covariance_is_that_of_predictions(kind, frame):
    calibration = calibrated(kind, device_frame=frame, move_tip=True)
    covariance = calibration.covariance
    joints = configurations(40)
    found = calibration.predict(joints, with_uncertainty=True, model="calibrated")
    step = 1e-5
    places = lambda robot: robot.forward_kinematics(joints)[:, :3, 3]  # noqa: E731
    columns = [(places(moved(calibration, it, step)) - places(moved(calibration, it, -step))) / (2 * step) for it in covariance.names]
    jacobian = np.stack(columns, axis=-1)
    spread = np.einsum("mik,kl,mil->m", jacobian, covariance.matrix, jacobian)
    own = calibration.uncertainty["model_error"]["position_mm"] * 1e-3
    expected = np.sqrt(spread + 3 * own**2)
    inside = found.inside_sampled_range
    worst = np.abs(expected / found.sigma_position_m - 1)[inside].max()
    print(f"{inside.sum()} predictions, worst {worst:.1e}")
    assert inside.sum() >= 10 and worst < 1e-6


def test_unknowns_have_names_and_units(calibrations):
    covariance = calibrations["pose"].covariance
    motions = ["x", "y", "rx", "ry"]
    tip = [f"target.{turn}{axis}" for turn in ["", "r"] for axis in "xyz"]
    assert covariance.names == [f"joint{joint}.axis.{motion}" for joint in range(1, 7) for motion in motions] + tip
    units = {(len(name.split(".")[-1]), unit) for name, unit in zip(covariance.names, covariance.units, strict=True)}
    assert units == {(1, "m"), (2, "rad")}
    assert np.allclose(covariance.sigma, np.sqrt(np.diag(covariance.matrix))) and (covariance.matrix == covariance.matrix.T).all()
    assert np.linalg.eigvalsh(covariance.matrix / np.outer(covariance.sigma, covariance.sigma)).min() > 0
    assert len(covariance) == 30 and repr(covariance) == "<poecal.Covariance of 30 unknowns>"
    assert len(calibrations["point"].covariance) == 27


def test_a_sliding_joint_has_turns_alone():
    robot = poecal.Robot.from_dh(
        a_m=[0.3, 0.3, 0], alpha_rad=[0.1, np.pi / 2, 0.2], d_m=[0.1, 0, 0], theta_rad=[0, 0, 0],
        kinds=["revolute", "revolute", "prismatic"], limits=[[-2, 2], [-2, 2], [0, 0.5]],
    )  # fmt: skip
    made = poecal.simulate(robot, count=60)
    found = poecal.calibrate(made.nominal, made.measurements)
    assert [name for name in found.covariance.names if name.startswith("joint3")] == ["joint3.axis.rx", "joint3.axis.ry"]
    assert (pickle.loads(pickle.dumps(found)).covariance.matrix == found.covariance.matrix).all()


def test_a_fit_without_uncertainty_has_no_covariance():
    made = session(count=5)
    calibration = poecal.calibrate(made.nominal, made.measurements, held_out=0)
    assert calibration.uncertainty is None
    with pytest.raises(poecal.ModelError, match="found a calibration without uncertainty, expected more measurements than unknowns"):
        calibration.covariance  # noqa: B018


@pytest.mark.parametrize("held_out", [0.3, 0])
def test_a_picture_is_drawn_and_not_shown(held_out, tmp_path):
    import matplotlib.pyplot as plt

    seen = session("point", count=80).measurements
    positions = seen.positions
    positions[5] += 0.02
    rows = poecal.Measurements.from_arrays(elbow(), joints=seen.joints, positions=positions)
    with pytest.warns(poecal.PoecalWarning):
        calibration = poecal.calibrate(elbow(), rows, held_out=held_out)
    assert calibration.residuals.suspected.sum() == 1
    figure = calibration.plot()
    figure.savefig(tmp_path / "errors.png")
    assert (tmp_path / "errors.png").read_bytes().startswith(b"\x89PNG") and plt.get_fignums() == []
    errors, of_rows = figure.axes
    assert [text.get_text() for text in errors.get_legend().get_texts()] == ["your model, tool and device located", "calibrated"]
    sets = ["fitted", "held out", "suspected"] if held_out else ["fitted", "suspected"]
    assert [text.get_text() for text in of_rows.get_legend().get_texts()] == sets
    assert sum(len(line.get_xdata()) for line in of_rows.lines) == 81
    given, axes = plt.subplots(2, 1)
    assert calibration.plot(axes) is given and calibration.plot(list(axes)) is given
    plt.close(given)


@pytest.mark.parametrize(
    ("package", "call"),
    [("pandas", "residuals.to_dataframe()"), ("polars", "residuals.to_polars()"), ("matplotlib", "plot()")],
)
def test_a_package_that_is_missing_is_named(package, call):
    code = f"""
import sys
sys.modules["{package}"] = None
import poecal
made = poecal.simulate(poecal.Robot.from_text({elbow().to_text("toml")!r}))
try:
    poecal.calibrate(made.nominal, made.measurements).{call}
except ImportError as error:
    assert isinstance(error, poecal.PackageError)
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.stdout == f"found no package `{package}`, expected it to be installed: pip install {package}\n", run.stderr
