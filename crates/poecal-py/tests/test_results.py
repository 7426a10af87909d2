"""Results print their answer, have the important numbers as attributes, and are tables, dicts and JSON."""

import copy
import json
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas
import poecal
import pytest
from robots import elbow
from test_hand_eye import session


@pytest.fixture(scope="module")
def made() -> poecal.Simulation:
    return poecal.simulate(elbow(), kind="point", count=60, seed=5, held_out_count=20)


@pytest.fixture(scope="module")
def calibration(made) -> poecal.Calibration:
    return poecal.calibrate(made.nominal, made.measurements)


@pytest.fixture(scope="module")
def results(made, calibration, tmp_path_factory) -> dict[str, poecal.Findings]:
    folder = tmp_path_factory.mktemp("made") / "made"
    made.write(folder)
    arm, seen = session()
    joints = made.measurements.joints
    return {
        "Check": poecal.check(folder / "nominal.toml", folder / "measurements.csv"),
        "ColumnGuess": poecal.guess_columns(folder / "measurements.csv", made.nominal),
        "Offsets": poecal.offsets(made.nominal, calibration),
        "Comparison": poecal.compare(calibration, calibration),
        "Validation": calibration.validate(made.held_out, accept="0.5mm"),
        "Visit": poecal.track(calibration, made.measurements[:8], made.measurements),
        "VisitPlan": poecal.plan(calibration, purpose="drift", count=6),
        "Identification": calibration.identify(joints, kind="point"),
        "WatchedRow": poecal.Watch(made.nominal).add_all(made.measurements[:12])[-1],
        "HandEye": poecal.hand_eye(arm, seen, camera="in-hand"),
        "ToolTip": poecal.tcp(np.array([arm[k] for k in range(12)])),
        "Iso9283": poecal.iso9283(Path(__file__).resolve().parents[3] / "examples/howto/iso9283.csv", accept="AP:1mm"),
        "Compensation": calibration.compensate(joints, summary=True, max_turn_deg=60)[1],
        "Reproduction": poecal.reproduce("lou2009", trials=2, starts=1),
    }


def test_each_says_its_answer_in_one_line(results):
    for name, found in results.items():
        print(repr(found))
        assert type(found).__name__ == name and isinstance(found, poecal.Findings)
        assert repr(found) == f"<poecal.{name}: {found.answer}>" and len(repr(found)) < 320
        assert found.answer and "\n" not in found.answer and not found.answer.endswith(".")


def test_each_is_a_mapping_of_what_the_program_prints(results):
    for found in results.values():
        whole = found.to_dict()
        assert whole == json.loads(found.to_json()) == dict(found) == found
        assert list(found) == list(whole) and len(found) == len(whole) and "no such key" not in found
        # A change in a copy does not change the result.
        whole.clear()
        assert len(found) > 0
        with pytest.raises(KeyError):
            found["no such key"]


def test_each_is_pickled_and_copied(results):
    for found in results.values():
        for again in (pickle.loads(pickle.dumps(found)), copy.copy(found), copy.deepcopy(found)):
            assert type(again) is type(found) and again == found and str(again) == str(found) and repr(again) == repr(found)
            assert again.warnings == found.warnings and again._repr_html_() == found._repr_html_()


def test_each_is_a_table(results):
    counts = {"Check": 9, "Offsets": 6, "Comparison": 6, "Validation": 1, "Visit": 6, "VisitPlan": 6, "Identification": 6, "WatchedRow": 1}
    counts |= {"ColumnGuess": len(results["ColumnGuess"]["fields"]), "HandEye": 2, "ToolTip": 1, "Iso9283": 12, "Compensation": 60, "Reproduction": len(results["Reproduction"]["claims"])}
    for name, found in results.items():
        frame = found.to_dataframe()
        print(name, list(frame.columns))
        assert isinstance(frame, pandas.DataFrame) and len(frame) == counts[name], name
    assert list(results["Comparison"].to_dataframe()["change.words"]) == [joint["change"]["words"] for joint in results["Comparison"]["joints"]]
    assert {"model", "quantity", "mean", "rms", "p95", "max"} <= set(results["Validation"].to_dataframe().columns)


def test_attributes_are_the_numbers_of_the_parts(results, made):
    check, offsets, compared, judged = (results[name] for name in ("Check", "Offsets", "Comparison", "Validation"))
    assert (check.count, check.joints, check.mistakes) == (60, made.nominal.joint_names, [])
    assert check.answer == "60 rows, no mistake found" == poecal.check(made.nominal, made.measurements).answer
    assert poecal.check(made.nominal).count == 0 and poecal.check(made.nominal).answer.startswith("elbow: 6 revolute")
    assert list(offsets.offsets_deg) == made.nominal.joint_names and offsets.offsets_mm == {}
    assert offsets.offsets_deg["joint2"] == offsets["joints"][1]["offset_deg"]
    assert offsets.with_rms_mm == offsets["predictions"]["with_offsets"]["position_rms_mm"] <= offsets.with_max_mm
    assert offsets.without_rms_mm == offsets["predictions"]["without_offsets"]["position_rms_mm"]
    assert offsets.undetermined == offsets["undetermined"] and f"joint2 {offsets.offsets_deg['joint2']:.4f} deg" in repr(offsets)
    assert compared.moved is False and compared.changed is False and compared.changed_joints == []
    assert compared.tip_rms_mm < 1e-9 < compared.limit_mm and "still good" in repr(compared)
    assert judged.model == "calibrated" and judged.level == "good" and judged.count == 20 and judged.accepted is True
    assert judged.position_rms_mm == judged["calibrated"]["position_mm"]["rms"] <= judged.position_max_mm
    assert judged.rotation_rms_deg is None and 0.8 <= judged.inside_bound95 <= 1 and judged.expected_rms_mm > 0
    assert "the calibration holds" in repr(judged)
    visit, plan = results["Visit"], results["VisitPlan"]
    assert not visit.changed and visit.explanation is None and visit.joint is None and visit.unseen == ["joint1"]
    assert visit.change_mm >= 0 and visit.noise_mm > 0 and visit.error_mm > 0 and "unchanged" in repr(visit)
    assert plan.unseen == ["joint1", "joint6"] and set(plan.smallest_deg) == set(made.nominal.joint_names) and plan.smallest_mm == {}
    assert plan.smallest_deg["joint1"] is None and 0 < plan.smallest_deg["joint3"] < 1 and plan.noise_mm > 0


def test_sessions_have_their_numbers_too(results):
    identified, row, camera, tip = (results[name] for name in ("Identification", "WatchedRow", "HandEye", "ToolTip"))
    assert identified.determined == identified.unknowns == 27 and identified.undetermined == []
    assert len(identified.weak) == len(identified["identifiability"]["weak"])
    assert identified.expected_calibrated_mm == identified["expected"]["calibrated_mm"]
    assert identified.expected_corrected_mm == identified["expected"]["corrected_mm"]
    assert row.row == 12 and row.ok in (True, None) and row.mistake is None and row.next.shape == (6,)
    assert row.expected_calibrated_mm == row["expected_calibrated_mm"] and row.expected_corrected_mm == row["expected_corrected_mm"]
    assert camera.level == "good" and camera.camera_pose.shape == (4, 4) and camera.reasons == camera["verdict"]["reasons"]
    assert camera.bound95_mm == camera["camera_frame"]["bound95_mm"] and 0 < camera.bound95_deg < 1
    assert tip.position_m.shape == (3,) and tip.bound95_mm == tip["tips"][0]["bound95_mm"] and tip.level == tip["verdict"]["level"]
    compensated, repeated = results["Compensation"], results["Reproduction"]
    assert compensated.count == 60 and compensated.left_out == [] and compensated.left_max_mm < 1e-6 < compensated.off_max_mm
    assert repeated.holding == sum(claim["holds"] for claim in repeated["claims"] if claim["said_by_paper"])
    assert f"{repeated.holding} of " in repr(repeated)


def test_a_mistake_is_the_answer(made):
    wrong = poecal.Measurements.from_arrays(
        made.nominal, joints=made.measurements.joints * [1, -1, 1, 1, 1, 1], positions=made.measurements.positions
    )
    check = poecal.check(made.nominal, wrong)
    assert check.mistakes and check.mistakes[0] in check.answer and "joint2" in check.answer


def test_without_pandas_a_sentence_says_what_to_install(results):
    code = "import sys; sys.modules['pandas'] = None; import poecal; poecal.check(poecal.Robot.from_dh(a_m=[1], alpha_rad=[0], d_m=[0], theta_rad=[0])).to_dataframe()"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.returncode == 1
    assert run.stderr.strip().endswith("found no package `pandas`, expected it to be installed: pip install pandas")


def test_the_delivered_model_is_shown():
    made = poecal.simulate(elbow(), count=110, terms={"sag": 2e-3, "harmonics": 3e-4}, held_out_count=60, seed=3)
    calibration = poecal.calibrate(made.nominal, made.measurements)
    assert calibration.verdict.model == "corrected" == calibration.residuals.model
    held_out = calibration.accuracy.held_out
    assert f"corrected model {held_out.corrected.position_mm.rms:.4f} mm RMS on" in repr(calibration)
    assert repr(calibration.accuracy).startswith(f"<poecal.Accuracy of the corrected model: {held_out.corrected.position_mm.rms:.4f} mm RMS on")
    assert f"{calibration.verdict.expected_error_mm:.4f} mm expected" in repr(calibration)
    assert "<th>corrected</th>" in calibration._repr_html_() and f"{held_out.corrected.position_mm.rms:.4f} mm" in calibration._repr_html_()
    residuals = calibration.residuals
    assert np.array_equal(residuals.errors("position"), residuals.position_corrected_mm)
    drawn = calibration.plot().axes
    assert [text.get_text() for text in drawn[0].get_legend().get_texts()] == ["your model, tool and device located", "corrected"]
    assert drawn[1].get_title() == "corrected, row by row"
    held = np.flatnonzero(residuals.held_out)
    shown = {line.get_label(): line for line in drawn[1].lines}["held out"].get_ydata()
    assert np.array_equal(shown, residuals.position_corrected_mm[held])
    off = poecal.calibrate(made.nominal, made.measurements, corrections="off")
    assert "calibrated model" in repr(off) and "of the calibrated model" in repr(off.accuracy) and off.residuals.model == "calibrated" and "<th>corrected</th>" not in off._repr_html_()
    assert off.plot().axes[1].get_title() == "calibrated, row by row"
