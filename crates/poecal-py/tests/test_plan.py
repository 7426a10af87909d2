"""`poecal.plan` and `poecal.Watch`, as the program plans and watches."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import poecal
import pytest
from robots import elbow


def test_a_plan_is_that_of_the_program(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(elbow().to_text("toml"))
    robot = poecal.Robot.read(path)
    planned = poecal.plan(robot, count=12, held_out_count=4, robot_error_mm=(0.2, 0.1), target_offset_mm=(60, 0, 30))
    words = ["plan", str(path), "--count", "12", "--held-out-count", "4", "--robot-error", "0.2mm,0.1mm", "--target-offset", "60,0,30mm", "--json"]
    by_program = json.loads(subprocess.run([sys.executable, "-m", "poecal", *words], capture_output=True, text=True, check=True).stdout)
    found = planned.to_dict()
    assert found == by_program | {"model": found["model"]}
    assert planned.joints.shape == (16, 6) and len(planned) == 16
    assert planned.sets.count("fit") == 12 and not any(planned.returns)
    assert planned.expected_calibrated_mm == pytest.approx(found["expected"]["calibrated_mm"])
    assert planned.expected_corrected_mm < planned.expected_calibrated_mm
    assert "12 configurations to fit" in str(planned) and repr(planned).startswith("<poecal.Plan of elbow: 12 configurations")
    planned.write(tmp_path / "joints.csv")
    assert np.allclose(poecal.read_joints(tmp_path / "joints.csv", robot), planned.joints, atol=1e-6)
    planned.write_program(tmp_path / "joints.script")
    assert (tmp_path / "joints.script").read_text().count("movej") == 16
    planned.write_report(tmp_path / "plan.html")
    with pytest.raises(poecal.FileError):
        planned.write(tmp_path / "joints.csv")
    better = poecal.plan(robot, keep_rows=planned, replace_rows=[2, 13], robot_error_mm=(0.2, 0.1), target_offset_mm=(60, 0, 30))
    changed = [row for row in range(16) if not np.array_equal(better.joints[row], planned.joints[row])]
    assert changed == [2, 13] and better.sets == planned.sets


def test_conditions_are_kept_and_mistakes_are_one_sentence():
    robot = elbow()
    planned = poecal.plan(robot, count=8, held_out_count=0, margin_deg_mm=(20, 0), separation_deg=25, floor_height_mm=-700, device_mm=(3000, 0, 500), device_half_angle_deg=40, corrections="off")
    tips = robot.forward_kinematics(planned.joints)[:, :3, 3]
    away = tips - np.array([3.0, 0, 0.5])
    angle = np.degrees(np.arccos((away @ np.array([-3.0, 0, -0.5])) / np.linalg.norm(away, axis=1) / np.hypot(3.0, 0.5)))
    assert (tips[:, 2] >= -0.7).all() and (angle <= 40).all()
    for change, words in [
        ({"count": 0}, "count: found 0, expected 1 to 1000"),
        ({"device_half_angle_deg": 30}, "device_half_angle_deg: found it without device_mm"),
        ({"criterion": "F"}, "criterion: found `F`, expected one of expected, D, A, E, G"),
        ({"robot_error_mm": (0.1, 0.2)}, "robot_error_mm: found .*, expected the error of the calibrated model and the smaller one"),
        ({"keep_out_mm": [[1, 2, 3]]}, r"keep_out_mm\[0\]: found an array of shape \(3,\)"),
        ({"replace_rows": [0]}, "found 0, expected a row of keep"),
        ({"workspace": np.zeros((3, 6)), "workspace_box_mm": np.zeros((2, 3))}, "found both workspace and workspace_box_mm"),
    ]:
        with pytest.raises(poecal.OptionError, match=words):
            poecal.plan(robot, **change)


def test_rows_are_judged_as_they_arrive():
    robot = elbow()
    made = poecal.simulate(robot, kind="point", count=30, seed=4)
    joints, positions = made.measurements.joints, made.measurements.positions.copy()
    positions[20] += [0, 0.01, 0]
    watch = poecal.Watch(made.nominal, robot_error_mm=(0.1, 0.05), candidates=joints)
    rows = [watch.add(readings, position=position, id=f"row {at}") for at, (readings, position) in enumerate(zip(joints, positions))]
    named = [at for at, row in enumerate(rows) if row["ok"] is False]
    print("named", named, rows[20]["sentence"], "noticed", rows[20]["noticed_mm"])
    assert named == [20] and rows[20]["id"] == "row 20" and len(watch) == 30
    assert rows[0]["ok"] is None and rows[-1]["expected_corrected_mm"] < rows[6]["expected_corrected_mm"]
    # A measured configuration is not advised again; the same rows at once have the same judgement.
    known = {tuple(row) for row in np.round(joints[:11], 9)}
    assert tuple(np.round(rows[10]["next"], 9)) not in known
    again = poecal.Watch(made.nominal, robot_error_mm=(0.1, 0.05), candidates=joints).add_all(made.measurements[:20])
    assert [row.to_dict() | {"id": None} for row in again] == [row.to_dict() | {"id": None} for row in rows[:20]]
    with pytest.raises(poecal.OptionError, match="positions: found neither positions nor poses"):
        watch.add(joints[0])


def test_paths_are_read_and_a_certificate_is_written(tmp_path, capfd):
    made = poecal.simulate(elbow(), kind="point", count=40)
    made.write(tmp_path / "made")
    calibration = poecal.calibrate(tmp_path / "made/nominal.toml", [tmp_path / "made/measurements.csv"], progress=True)
    assert "####" in capfd.readouterr().err
    assert calibration == poecal.calibrate(poecal.Robot.read(tmp_path / "made/nominal.toml"), str(tmp_path / "made/measurements.csv"))
    assert "40 points" in str(poecal.check(str(tmp_path / "made/nominal.toml"), tmp_path / "made/measurements.csv"))
    calibration.certificate(tmp_path / "certificate.html", record={"valid_until": "2027-11-28", "serial": "4711"})
    page = (tmp_path / "certificate.html").read_text()
    assert "4711" in page and "2027-11-28" in page
    with pytest.raises(poecal.OptionError, match="expected a day like"):
        calibration.certificate(tmp_path / "no.html", record={"valid_until": "soon"})


def test_visits_are_planned_as_by_the_program(tmp_path):
    made = poecal.simulate(elbow(), kind="point", count=60, seed=5)
    made.write(tmp_path / "made")
    robot = poecal.Robot.read(tmp_path / "made/nominal.toml")
    measured = poecal.Measurements.from_csv(tmp_path / "made/measurements.csv", robot)
    fitted = poecal.calibrate(robot, measured)
    fitted.write(tmp_path / "results")
    read = poecal.Calibration.read(tmp_path / "results/calibration.json")

    def by_program(*words):
        command = [sys.executable, "-m", "poecal", "plan", str(tmp_path / "results/calibration.json"), "--purpose", "drift", *words, "--json"]
        command += ["--out", str(tmp_path / "by-program.csv"), "--force"]
        return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)

    for options, words in [
        ({}, []),
        ({"count": 6, "device": "known", "tool": "refit", "repeatability_mm": "50um"}, ["--count", "6", "--device", "known", "--tool", "refit", "--repeatability", "0.05mm"]),
    ]:
        told = by_program(*words)
        for calibration, earlier in [(fitted, None), (read, None), (read, measured)]:
            planned = poecal.plan(calibration, purpose="drift", earlier=earlier, **options)
            assert {key: part for key, part in planned.to_dict().items() if key not in ("rows", "table")} == told
            assert planned["table"] == (tmp_path / "by-program.csv").read_text()
            assert planned.joints.shape == (options.get("count", 8), 6)
    # The configurations are measured ones, and the table is read once it is filled in.
    assert all(np.abs(made.measurements.joints - row).max(axis=1).min() < 1e-9 for row in planned.joints)
    planned.write(tmp_path / "visit.csv")
    assert np.allclose(poecal.read_joints(tmp_path / "visit.csv", robot), planned.joints, atol=1e-6)
    with pytest.raises(poecal.FileError):
        planned.write(tmp_path / "visit.csv")
    planned.write(tmp_path / "visit.csv", force=True)
    frame = planned.to_dataframe()
    assert np.allclose(np.radians(frame[[f"{name}[deg]" for name in robot.reading_names]]), planned.joints, atol=1e-6) and frame["x[mm]"].isna().all()
    new = poecal.plan(fitted, purpose="drift", count=5, candidates=poecal.plan(robot, count=20, held_out_count=0).joints)
    assert new["are_new"] is True and len(new.joints) == 5


def test_mistakes_in_planned_visits_are_one_sentence(tmp_path):
    made = poecal.simulate(elbow(), kind="point", count=40)
    made.write(tmp_path / "made")
    robot = poecal.Robot.read(tmp_path / "made/nominal.toml")
    calibration = poecal.calibrate(robot, tmp_path / "made/measurements.csv")
    for change, words in [
        ({"purpose": "drift", "floor_height_mm": 20}, 'floor_height_mm: found it with purpose="drift", expected only candidates, count, earlier'),
        ({"purpose": "drift", "count": 41}, "40 measured configurations"),
        ({"purpose": "drift", "count": 0}, "count: found 0, expected 1 to 1000"),
        ({"purpose": "drift", "device": "moved"}, "device: found `moved`, expected one of refit, known"),
        ({"purpose": "drifts"}, "purpose: found `drifts`, expected one of calibration, drift, iso9283; did you mean `drift`?"),
        ({"device": "known"}, 'device: found it without purpose="drift"'),
    ]:
        with pytest.raises(poecal.Error, match=words.replace("?", r"\?")):
            poecal.plan(calibration, **change)
    with pytest.raises(poecal.OptionError, match="robot: found Robot, expected a poecal.Calibration"):
        poecal.plan(robot, purpose="drift")
    calibration.write(tmp_path / "results")
    (tmp_path / "made/measurements.csv").unlink()
    read = poecal.Calibration.read(tmp_path / "results/calibration.json")
    with pytest.raises(poecal.OptionError, match="earlier: found none, and the measurements of the calibration .* are not where it was made"):
        poecal.plan(read, purpose="drift")


def test_a_plan_is_made_of_a_path_and_of_a_calibration(tmp_path):
    made = poecal.simulate(elbow(), kind="point", count=60, seed=5)
    made.write(tmp_path / "made")
    path = tmp_path / "made/nominal.toml"
    of_robot = poecal.plan(poecal.Robot.read(path), count=8, held_out_count=2)
    assert np.array_equal(poecal.plan(path, count=8, held_out_count=2).joints, of_robot.joints)
    frame = of_robot.to_dataframe()
    assert list(frame["set"]) == of_robot.sets and list(frame.columns[:3]) == ["id", "set", "returns"] and len(frame) == len(of_robot)
    assert json.loads(of_robot.to_json()) == of_robot.to_dict()
    calibration = poecal.calibrate(path, tmp_path / "made/measurements.csv")
    calibration.write(tmp_path / "results")
    read = poecal.Robot.read(tmp_path / "results/calibration.json")
    next_session = poecal.plan(calibration, count=8, held_out_count=2)
    assert next_session.to_dict()["robot_error_is_a_guess"] is False
    assert next_session.expected_calibrated_mm == poecal.plan(read, count=8, held_out_count=2).expected_calibrated_mm


def test_a_planned_test_is_that_of_the_program(tmp_path):
    made = poecal.simulate(elbow(), kind="point", count=10, seed=7)
    made.write(tmp_path / "made")
    model = tmp_path / "made/nominal.toml"
    options = [
        ({"floor_height_mm": 100, "count": 4}, ["--floor-height", "100mm", "--count", "4"]),
        ({"workspace_box_mm": [[700, -150, 500], [900, 150, 500]]}, ["--workspace", "700,-150,500:900,150,500mm"]),
    ]
    for at, (given, words) in enumerate(options):
        planned = poecal.plan(model, purpose="iso9283", **given)
        table, listing = tmp_path / f"{at}.csv", tmp_path / f"{at}.src"
        command = [sys.executable, "-m", "poecal", "plan", str(model), "--purpose", "iso9283", *words, "--out", str(table), "--program", str(listing), "--json"]
        told = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        assert planned.to_dict() == told and planned.cycles == told["cycles"]
        own, program = tmp_path / f"own-{at}.csv", tmp_path / f"own/{at}.src"
        program.parent.mkdir(exist_ok=True)
        planned.write(own)
        planned.write_program(program)
        assert own.read_text() == table.read_text() and program.read_text() == listing.read_text()
        assert planned.joints.shape == (5 * planned.cycles, 6)
        tips = poecal.Robot.read(model).forward_kinematics(planned.joints)[:5, :3, 3]
        assert np.allclose(1e3 * tips[::-1], [pose["position_mm"] for pose in told["poses"]], atol=1e-6)
    for name, value in [("seed", 3), ("candidates", [[0.0] * 6]), ("kind", "pose")]:
        with pytest.raises(poecal.Error, match=f"^{name}: found it with purpose=\"iso9283\", expected only count, workspace_box_mm and floor_height_mm"):
            poecal.plan(model, purpose="iso9283", **{name: value})


def test_a_test_is_written_as_pages(tmp_path):
    rows = Path(__file__).resolve().parents[3] / "examples/howto/iso9283.csv"
    page, certificate = tmp_path / "page.html", tmp_path / "certificate.html"
    found = poecal.iso9283(rows, report=page, record={"warm_up": "1 h"})
    poecal.iso9283(rows, report=certificate, certificate=True)
    assert f"{found.ap_mm:.4f}" in page.read_text() and "1 h" in page.read_text()
    assert certificate.read_text().count("<svg") < page.read_text().count("<svg")
    with pytest.raises(poecal.FileError):
        poecal.iso9283(rows, report=page)
    with pytest.raises(poecal.Error, match="^certificate: found it without report"):
        poecal.iso9283(rows, certificate=True)
