"""Limits and record in Python: the same figures as in calibration.json, and one sentence for each mistake."""

from pathlib import Path

import pytest

import poecal

ELBOW = Path(__file__).resolve().parents[3] / "examples/elbow"


@pytest.fixture(scope="module")
def made():
    robot = poecal.Robot.read(ELBOW / "robot.urdf")
    return robot, poecal.Measurements.from_csv(ELBOW / "points.csv", robot)


def test_limits_are_judged_and_a_record_is_kept(made):
    robot, measured = made
    record = {"serial": "4711", "temperature": "21.5C", "note": ""}
    calibration = poecal.calibrate(robot, measured, accept="10mm", accept_model="calibrated", record=record)
    assert calibration.record == {"serial": "4711", "temperature": "21.5 °C"}
    found = calibration.acceptance
    assert (found["decision"], found["model"], found["by"]) == ("pass", "calibrated", "held_out")
    limit = found["limits"][0]
    rms = calibration.accuracy.held_out.calibrated.position_mm.rms
    print(limit)
    # Sums of the same squares in another order.
    assert limit["found"] == pytest.approx(rms, rel=1e-9)
    assert limit["from"] < rms < limit["to"]
    fails = poecal.calibrate(robot, measured, accept=f"{limit['from'] * 0.99}mm", accept_model="calibrated")
    assert fails.acceptance["decision"] == "fail"
    assert poecal.calibrate(robot, measured).acceptance is None


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"accept": 0.2}, "accept: found 0.2, expected a text, like"),
        ({"accept": "0.2"}, "accept: found `0.2` as a limit, expected a unit behind the number"),
        ({"accept": "1deg"}, "measured no angle, only position"),
        ({"accept_model": "calibrated"}, "found `calibrated` as the model that shall keep limits, but no limit"),
        ({"accept": "1mm", "accept_model": "nominal"}, "accept_model: found"),
        ({"record": "serial"}, "record: found the text `serial`, expected a dict of keys and texts"),
        ({"record": {"serial": 4711}}, 'record["serial"]: found 4711, expected a text'),
        ({"record": {"sreial": "1"}}, "record: found the key `sreial`"),
        ({"record": {"date": "2026-02-30"}}, "expected a day like 2026-03-02"),
    ],
)
def test_what_is_wrong_is_refused_by_one_sentence(made, arguments, sentence):
    robot, measured = made
    with pytest.raises(poecal.Error) as error:
        poecal.calibrate(robot, measured, **arguments)
    assert sentence in str(error.value)
