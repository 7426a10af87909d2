"""The corrected model: joint effects beyond geometry, found, predicted, written and read back."""

import pickle

import numpy as np
import poecal
import pytest
from robots import configurations, elbow


@pytest.fixture(scope="module")
def made() -> poecal.Simulation:
    return poecal.simulate(elbow(), count=110, terms={"sag": 2e-3, "harmonics": 3e-4}, held_out_count=60, seed=3)


@pytest.fixture(scope="module")
def calibration(made) -> poecal.Calibration:
    return poecal.calibrate(made.nominal, made.measurements)


def test_what_joints_do_is_found(made, calibration):
    held_out = calibration.accuracy.held_out
    print(calibration)
    assert held_out.corrected.position_mm.rms < 0.15 < 0.3 < held_out.calibrated.position_mm.rms
    left = calibration.validate(made.held_out)
    assert left["corrected"]["position_mm"]["rms"] < 0.2 * left["calibrated"]["position_mm"]["rms"]
    assert left["corrected"]["promised"]["position_mm"]["inside_bound95"] > 0.9
    sizes = calibration.corrected["sizes"]
    assert sizes["sag"] > 0 and sizes["harmonics"] > 0
    assert any("sags" in effect["words"] for effect in calibration.corrected["effects"])
    residuals = calibration.residuals
    assert residuals.position_corrected_mm.mean() < residuals.position_calibrated_mm.mean()
    assert "position_corrected[mm]" in residuals.to_dict()


def test_the_corrected_model_predicts_unless_the_other_is_asked_for(calibration):
    joints = configurations(10)
    corrected, calibrated = (calibration.predict(joints, model=model) for model in ("corrected", "calibrated"))
    assert np.array_equal(calibration.predict(joints), corrected)
    assert np.array_equal(calibration.robot.forward_kinematics(joints), calibrated)
    assert np.allclose(calibration.corrected_robot.forward_kinematics(joints), corrected, atol=1e-14, rtol=0)
    apart = np.linalg.norm(corrected[:, :3, 3] - calibrated[:, :3, 3], axis=1)
    assert 1e-5 < apart.max() < 5e-2
    assert calibration.predict(joints, with_uncertainty=True).bound95_position_m.shape == (10,)


def test_it_comes_back_from_files_and_pickles(calibration, tmp_path):
    calibration.write(tmp_path / "results")
    read = poecal.Calibration.read(tmp_path / "results" / "calibration.json")
    again = pickle.loads(pickle.dumps(calibration))
    joints = configurations(5)
    for other in (read, again):
        assert np.array_equal(other.predict(joints), calibration.predict(joints))
        assert other.accuracy.held_out.corrected == calibration.accuracy.held_out.corrected


def test_terms_can_be_left_out_and_chosen(made):
    off = poecal.calibrate(made.nominal, made.measurements, corrections="off")
    assert off.corrected is None and off.corrected_robot is None and off.accuracy.held_out.corrected is None
    assert np.isnan(off.residuals.position_corrected_mm).all()
    assert np.array_equal(off.predict(configurations(3)), off.robot.forward_kinematics(configurations(3)))
    sag = poecal.calibrate(made.nominal, made.measurements, corrections={"sag": 1e-3}, gravity="find", harmonics=3)
    assert sag.corrected["sizes"] == {"sag": 1e-3, "tilt": 0, "ratio": 0, "harmonics": 0, "wobble": 0, "backlash": 0, "factors": 0, "payload": 0, "shift": 0, "runout": 0}
    direction = sag.corrected["robot"]["gravity"]["direction"]
    # 2 mrad of sag against 0.05 mm determine the direction to some degrees.
    assert direction[2] < -0.98


def test_backlash_is_found_by_the_side_of_the_approach(tmp_path):
    made = poecal.simulate(elbow(), count=90, terms={"backlash": 3e-4}, held_out_count=40)
    robot = elbow().with_factors([f"approach_{name}" for name in elbow().joint_names])
    assert robot.reading_names == made.nominal.reading_names == made.measurements.reading_names
    found = poecal.calibrate(robot, made.measurements)
    left = found.validate(made.held_out)
    assert left["corrected"]["position_mm"]["rms"] < 0.3 * left["calibrated"]["position_mm"]["rms"]
    assert found.corrected["sizes"]["backlash"] > 0
    found.write(tmp_path / "results")
    read = poecal.Calibration.read(tmp_path / "results" / "calibration.json")
    assert np.array_equal(read.predict(made.held_out.joints), found.predict(made.held_out.joints))
    with pytest.raises(poecal.OptionError, match="found the factor `joint1`, expected a name that no joint"):
        elbow().with_factors(["joint1"])


@pytest.mark.parametrize(
    ("argument", "sentence"),
    [
        ({"corrections": "sga"}, "corrections: found `sga`, expected auto, all, off, or some of sag, tilt, ratio, harmonics, wobble"),
        ({"corrections": {"sag": 2.0}}, "corrections: found `2e0` as the size of sag, expected radians from 1e-9 to 1"),
        ({"corrections": 3}, "corrections: found 3, expected a text, or a dict of groups of terms and their sizes"),
        ({"gravity": (0, 0, 0)}, "gravity: found"),
        ({"gravity": (0, 1)}, "gravity: found 2 numbers, expected three"),
        ({"gravity": "down"}, "gravity: found `down`, expected a direction of three numbers"),
        ({"harmonics": 9}, "harmonics: found 9, expected 1 to 8"),
        ({"tolerance_deg_mm": "wide"}, "tolerance_deg_mm: found the text `wide`, expected two numbers"),
    ],
)
def test_mistakes_are_one_sentence(made, argument, sentence):
    with pytest.raises((poecal.OptionError, TypeError, ValueError)) as error:
        poecal.calibrate(made.nominal, made.measurements, **argument)
    assert sentence in str(error.value)


def test_a_tolerance_is_chosen(made):
    found = poecal.calibrate(made.nominal, made.measurements, tolerance_deg_mm="auto", corrections="off")
    chosen = found.to_dict()["solver"]["chosen_tolerance"]["angle_deg"]
    assert min(abs(chosen - it) for it in (0.2, 0.5, 3.0)) < 1e-9
