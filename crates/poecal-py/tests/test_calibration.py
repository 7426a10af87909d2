"""Calibrations: their findings and messages, and their exact restoration."""

import copy
import json
import pickle
import threading
import time
from pathlib import Path

import numpy as np
import poecal
import pytest
from robots import configurations, elbow, session

EXAMPLE = Path(__file__).resolve().parents[3] / "examples/elbow/robot.urdf"


@pytest.fixture(scope="module")
def made() -> poecal.Simulation:
    return session(held_out_count=40)


@pytest.fixture(scope="module")
def calibration(made) -> poecal.Calibration:
    return poecal.calibrate(made.nominal, made.measurements)


def test_a_calibration_finds_the_robot_that_is_there(made, calibration):
    accuracy = calibration.accuracy
    assert (accuracy.training.count, accuracy.held_out.count) == (35, 15)
    # Noise of 0.05 mm in three components is 0.087 mm; the fit adds little to it.
    assert accuracy.held_out.registered.position_mm.rms > 10 > 0.15 > accuracy.held_out.calibrated.position_mm.rms
    assert calibration.converged and calibration.verdict.level == "good" and calibration.verdict.reasons
    assert calibration.verdict.is_at_least("inside_sampled_range")
    # Free of noise, the remaining error is that of the robot.
    left = calibration.validate(made.held_out)
    print(left)
    assert left["calibrated"]["position_mm"]["rms"] < 0.06 and left["count"] == 40
    assert left.warnings == []


def test_a_prediction_is_forward_kinematics(calibration):
    joints = configurations(20)
    poses = calibration.predict(joints)
    assert poses.shape == (20, 4, 4)
    assert (poses == calibration.robot.forward_kinematics(joints)).all()
    assert calibration.predict(joints[0]).shape == (4, 4)
    device = calibration.predict(joints, output_frame="device")
    # The device sees the target, which is not the tip.
    target = calibration.predict(joints, target="measured")
    assert np.allclose(calibration.base_from_device @ device, target, atol=1e-12) and not np.allclose(target, poses, atol=1e-4)


def test_a_prediction_says_what_to_expect(made, calibration):
    # Compared in the device's frame: the base frame is a choice.
    found = calibration.predict(made.held_out.joints, with_uncertainty=True, output_frame="device")
    errors = np.linalg.norm(found.poses[:, :3, 3] - made.held_out.positions, axis=1)
    print(f"errors {1e3 * errors.mean():.4f} mm, expected {1e3 * found.sigma_position_m.mean():.4f} mm")
    assert found.sigma_position_m.shape == found.sigma_rotation_rad.shape == found.inside_sampled_range.shape == (40,)
    assert (errors < found.bound95_position_m).mean() > 0.8
    assert len(found) == 40
    single = calibration.predict(made.held_out.joints[0], with_uncertainty=True)
    assert single.poses.shape == (1, 4, 4)


def test_all_options_are_taken(made):
    options = {
        "device_frame": "unknown", "sigma_position_mm": 0.05, "sigma_rotation_deg": 0.01, "held_out": 0.2, "seed": 3, "robust": "huber",
        "formulation": "screw", "residual": "spatial", "method": "gauss-newton",
    }  # fmt: skip
    told = []
    found = poecal.calibrate(made.nominal, made.measurements, **options, progress=told.append).to_dict()
    assert found["accuracy"]["held_out"]["count"] == 10
    assert found["noise"] == {"sigma": {"position_mm": 0.05, "rotation_deg": 0.01}, "source": "given"}
    assert found["solver"]["formulation"] == "screw" and found["solver"]["pose_residual"] == "spatial"
    assert found["solver"]["method"] == "gauss-newton" and found["robust"]["loss"] == "huber"
    assert told == ["finding the device frame and the targets", "fitting the screws", "judging the result"]


def test_few_configurations_are_all_fitted():
    few = session(count=20)
    all_fitted = poecal.calibrate(few.nominal, few.measurements)
    assert (all_fitted.accuracy.held_out, all_fitted.accuracy.few_configurations) == (None, 20)
    assert "all 20 configurations were fitted, since fewer than 12 would judge" in " ".join(str(all_fitted).split())
    some = poecal.calibrate(few.nominal, few.measurements, held_out=0.3).accuracy
    assert (some.held_out.count, some.few_configurations) == (6, None)


def test_rows_are_held_out_as_asked(made):
    judged = poecal.calibrate(made.nominal, made.measurements, validate=made.held_out)
    assert (judged.accuracy.training.count, judged.accuracy.held_out.count) == (50, 40)
    seen = made.measurements
    stated = poecal.Measurements.from_arrays(elbow(), joints=seen.joints, poses=seen.poses, sets=["fit"] * 45 + ["held_out"] * 5)
    assert poecal.calibrate(elbow(), stated).accuracy.held_out.count == 5
    assert poecal.calibrate(elbow(), stated, held_out=0).accuracy.held_out is None
    with pytest.raises(poecal.OptionError, match=r"found held_out 0.2, but what each row says of its set already says"):
        poecal.calibrate(elbow(), stated, held_out=0.2)
    with pytest.warns(poecal.PoecalWarning, match="seed has no effect"):
        poecal.calibrate(elbow(), stated, seed=3)


def test_exceptions_of_progress_arrive(made):
    def stop(_):
        raise KeyError("stop")

    with pytest.raises(KeyError, match="stop"):
        poecal.calibrate(made.nominal, made.measurements, progress=stop)


def test_files_are_written_and_read_back(calibration, tmp_path):
    names = calibration.write(tmp_path / "out")
    assert names == ["calibration.json", "calibrated.toml", "calibrated.urdf", "residuals.csv", "report.html"]
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == sorted(names)
    assert (tmp_path / "out/calibration.json").read_text() == calibration.to_json()
    assert (tmp_path / "out/residuals.csv").read_text() == calibration.residuals_csv()
    with pytest.raises(poecal.FileError, match="the output folder exists.*with force"):
        calibration.write(tmp_path / "out")
    assert "report.html" not in calibration.write(tmp_path / "out", force=True, report=False)
    calibration.write(tmp_path / "out", force=True, report=tmp_path / "elsewhere.html")
    again = poecal.Calibration.read(tmp_path / "out/calibration.json")
    again.report(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text() == (tmp_path / "elsewhere.html").read_text()
    assert again.accuracy == calibration.accuracy and again.verdict == calibration.verdict
    assert (again.predict(configurations(9)) == calibration.predict(configurations(9))).all()
    assert again.to_dict() == json.loads(calibration.to_json())
    assert again.robot.screws.tolist() == calibration.robot.screws.tolist()


def test_copies_are_equal_and_write_the_same_files(calibration, tmp_path):
    again = pickle.loads(pickle.dumps(calibration))
    assert again == calibration and copy.copy(calibration) == calibration and copy.deepcopy(calibration) == calibration
    assert str(again) == str(calibration) and repr(again) == repr(calibration)
    calibration.write(tmp_path / "one")
    again.write(tmp_path / "other")
    for path in (tmp_path / "one").iterdir():
        assert path.read_bytes() == (tmp_path / "other" / path.name).read_bytes(), path.name
    assert pickle.loads(pickle.dumps(again)) == again
    findings = calibration.identify(configurations(30))
    assert pickle.loads(pickle.dumps(findings)) == findings


def test_parts_are_those_of_the_file(calibration):
    found = calibration.to_dict()
    assert calibration.compensation == found["compensation"]
    assert calibration.corrections == found["corrections"] and calibration.uncertainty == found["uncertainty"]
    assert calibration.identifiability == found["identifiability"] and calibration.warnings == found["warnings"]
    assert found["inputs"] == {"model": "elbow", "measurements": ["simulated"], "sha256": {}, "command": None}


def test_a_calibration_shows_itself(calibration):
    assert str(calibration).startswith("verdict       good\nbefore ")
    verdict = calibration.verdict
    assert f"expected      {verdict.expected_error_mm:.4f} mm (RMS) near measured configurations, 95 % below {verdict.bound95_mm:.4f} mm" in str(calibration)
    assert "mm RMS on 15 held-out rows" in repr(calibration)
    html = calibration._repr_html_()
    assert html.startswith("<div>") and "held out" in html and "mm" in html


def test_what_measuring_would_tell():
    found = poecal.identify(elbow(), configurations(30), kind="point", sigma_position_mm=0.02)
    assert found["configurations"] == 30 and found["noise"]["position_mm"] == 0.02
    assert "determined" in str(found) and found.to_dict() == json.loads(found.to_json())


def test_mistakes_in_the_input_are_named(made):
    seen = made.measurements
    joints = seen.joints
    joints[:, 3] *= -1
    found = poecal.check(elbow(), poecal.Measurements.from_arrays(elbow(), joints=joints, poses=seen.poses))
    assert found["diagnosis"][0]["kind"] == "joint_sign"
    assert poecal.check(elbow())["model"]["name"] == "elbow"
    with pytest.warns(poecal.PoecalWarning, match="counting joint4 the other way"):
        calibration = poecal.calibrate(elbow(), poecal.Measurements.from_arrays(elbow(), joints=joints, poses=seen.poses))
    assert any("joint4" in warning for warning in calibration.warnings)


def test_simulations_are_written(made, tmp_path):
    names = made.write(tmp_path / "made")
    assert set(names) == {"nominal.toml", "nominal.urdf", "actual.toml", "actual.urdf", "measurements.csv", "held_out.csv", "truth.json"}
    assert poecal.Robot.read(tmp_path / "made/actual.toml").screws.shape == (6, 6)
    assert made.device_from_base.shape == (4, 4) and made.actual.name == "elbow_actual"
    # Numbers in files are rounded to a thousandth of their noise.
    seen = poecal.Measurements.from_csv(tmp_path / "made/measurements.csv", made.nominal)
    assert np.abs(seen.positions - made.measurements.positions).max() < 1e-7


def test_reproductions_are_reported(tmp_path):
    found = poecal.reproduce("lou2009", trials=2, starts=1, out=tmp_path / "lou")
    assert "What the paper says" in str(found) and len(found["runs"]) == 32
    assert (tmp_path / "lou/report.html").is_file()


def test_other_threads_go_on():
    """The interpreter is free while the library works: meanwhile a thread counts at a good part of the pace that it has alone."""
    made = session(count=5000)
    count, stop = 0, threading.Event()

    def counting():
        nonlocal count
        while not stop.is_set():
            count += 1

    def pace(work) -> float:
        before, start = count, time.perf_counter()
        work()
        return (count - before) / (time.perf_counter() - start)

    thread = threading.Thread(target=counting)
    thread.start()
    # The best of some tries, since other work of the machine may take its cores. With the lock held, the thread would get a few
    # switches of 5 ms in all.
    alone = max(pace(lambda: time.sleep(0.1)) for _ in range(3))
    beside = max(pace(lambda: poecal.calibrate(made.nominal, made.measurements)) for _ in range(5))
    stop.set()
    thread.join()
    print(f"counted {beside:.2e} a second while calibrating, {alone:.2e} alone")
    assert beside > 0.2 * alone


@pytest.mark.parametrize("count", [0, 100_000])
def test_more_threads_than_there_is_use_for_are_refused(count):
    with pytest.raises(poecal.OptionError, match=f"count: found {count}, expected a number from 1 to 256"):
        poecal.set_threads(count)


def test_threads_calibrate_at_once(made):
    expected = poecal.calibrate(made.nominal, made.measurements)
    found = [None] * 8

    def work(index):
        found[index] = poecal.calibrate(made.nominal, made.measurements).to_json()

    threads = [threading.Thread(target=work, args=(index,)) for index in range(8)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert set(found) == {expected.to_json()}


def test_every_way_back_keeps_the_urdf(tmp_path):
    """The text that was calibrated, with other numbers, from any folder."""
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(EXAMPLE.read_text().replace('<link name="base_link"/>', '<link name="base_link"/> <!-- mesh.stl -->'))
    robot = poecal.Robot.read(urdf)
    made = poecal.simulate(robot, kind="pose", count=40)
    fitted = poecal.calibrate(robot, made.measurements)
    fitted.write(tmp_path / "out")
    first = (tmp_path / "out/calibrated.urdf").read_text()
    urdf.unlink()
    assert "<!-- mesh.stl -->" in first
    again = poecal.Calibration.read(tmp_path / "out/calibration.json")
    again.write(tmp_path / "back")
    assert (tmp_path / "back/calibrated.urdf").read_text() == first
    for calibration in [fitted, again, pickle.loads(pickle.dumps(again))]:
        assert calibration.to_urdf() == calibration.export("urdf") == calibration.robot.to_text("urdf") == first
    with pytest.raises(ValueError, match="format: found `kuka`"):
        again.export("kuka")
