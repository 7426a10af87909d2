"""Kinematics and compensation."""

import subprocess
import sys

import numpy as np
import poecal
import pytest
from robots import elbow, session


@pytest.fixture(scope="module")
def calibration():
    return poecal.calibrate(elbow(), session(count=110, terms={"sag": 2e-3, "harmonics": 3e-4}, seed=3).measurements)


def poses_of(calibration, joints):
    return calibration.predict(joints)


def apart(one, other):
    """Largest distance of numbers."""
    return np.abs(one - other).max()


def test_compensated_joints_reach_what_the_nominal_robot_means(calibration):
    generator = np.random.default_rng(1)
    joints = generator.uniform(-1, 1, (200, 6)) + [0, 0.3, 0.3, 0, 1.5, 0]
    meant = calibration.taught().forward_kinematics(joints)
    # Errors of a degree require more than two for some joints.
    commanded = calibration.compensate(joints, max_turn_rad=1.0)
    assert commanded.shape == joints.shape
    reached = poses_of(calibration, commanded)
    print(f"without correction {np.linalg.norm((poses_of(calibration, joints) - reached)[:, :3, 3], axis=1).max() * 1e3:.2f} mm")
    assert apart(reached, meant) < 1e-10
    assert 1e-4 < np.median(np.abs(commanded - joints)) < 0.05
    assert apart(calibration.compensate(joints[3], max_turn_rad=1.0), commanded[3]) < 1e-10
    assert calibration.compensate(joints[3], max_turn_rad=1.0).shape == (6,)


def test_rows_that_stay_as_they_are_are_named(calibration):
    joints = np.random.default_rng(1).uniform(-1, 1, (200, 6)) + [0, 0.3, 0.3, 0, 1.5, 0]
    with pytest.warns(poecal.PoecalWarning, match=r"targets are left as the program has them.*the first on row \d+: joint `joint\d` would have to move by"):
        commanded, summary = calibration.compensate(joints, summary=True)
    listed = [it["line"] for it in summary["listed"]]
    print(f"{len(listed)} of 200 rows stay as they are, by at most {np.degrees(0.035):.1f} deg")
    assert len(listed) + summary["rows"] == 200 and [it["line"] for it in summary["targets"]] == sorted(set(range(200)) - set(listed))
    assert (commanded[listed] == joints[listed]).all()
    others = sorted(set(range(200)) - set(listed))
    assert np.abs(commanded - joints)[others].max(axis=1) == pytest.approx([it["change"] for it in summary["targets"]], abs=1e-15)
    for name in ("max_turn_rad", "max_slide_m"):
        for value in (0, -1.0, float("nan"), float("inf")):
            with pytest.raises(ValueError, match=f"{name}: found .*, expected a number above 0"):
                calibration.compensate(joints, **{name: value})


def test_taught_is_the_nominal_robot_with_another_base_and_tool(calibration):
    joints = np.random.default_rng(3).uniform(-2, 2, (50, 6))
    taught, nominal = (it.forward_kinematics(joints) for it in (calibration.taught(), calibration.nominal))
    # base · nominal · tool: motions between configurations turn by the same angles.
    first, turned = np.linalg.solve(taught[0], taught), np.linalg.solve(nominal[0], nominal)
    angles = [np.arccos(np.clip((np.trace(it[:, :3, :3], axis1=1, axis2=2) - 1) / 2, -1, 1)) for it in (first, turned)]
    assert apart(*angles) < 1e-7
    with pytest.raises(ValueError, match="model: "):
        calibration.taught(model="nominal")


def test_the_nearest_configuration_has_the_tip_at_the_pose(calibration):
    generator = np.random.default_rng(2)
    joints = generator.uniform(-1, 1, (200, 6)) + [0, 0.3, 0.3, 0, 1.5, 0]
    found = calibration.ik(poses_of(calibration, joints), near=joints + generator.uniform(-0.1, 0.1, joints.shape), limits=False)
    assert apart(found, joints) < 1e-8
    assert apart(calibration.ik(poses_of(calibration, joints[0]), near=joints[0], limits=False), joints[0]) < 1e-8
    far = np.eye(4)
    far[0, 3] = 9
    assert np.isnan(calibration.ik(far, near=joints[0])).all()


def test_all_branches_are_there_and_limits_are_kept(calibration):
    joints = np.array([[0.3, 0.4, -0.5, 0.6, 0.7, 0.8], [-0.3, 0.1, 0.5, 0.6, 0.9, -0.8]])
    poses = poses_of(calibration, joints)
    for target, q, branches in zip(poses, joints, calibration.ik(poses, limits=False), strict=True):
        assert branches.shape[0] >= 4 and branches.shape[1] == 6
        assert apart(poses_of(calibration, branches), target) < 1e-10
        assert np.abs(branches - q).max(axis=1).min() < 1e-8
    one = calibration.ik(poses[0])
    lower, upper = calibration.nominal.limits.T
    assert ((one >= lower - 1e-6) & (one <= upper + 1e-6)).all()
    assert len(one) <= len(calibration.ik(poses[0], limits=False))


@pytest.fixture(scope="module")
def seven():
    """A calibrated arm of seven axes with a round shoulder and wrist."""
    directions = [[0, 0, 1], [0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, 1], [0, 1, 0], [0, 0, 1]]
    heights = [0, 0.36, 0.36, 0.78, 0.78, 1.18, 1.18]
    screws = [np.concatenate([np.cross([0, 0, h], w), w]) for h, w in zip(heights, directions, strict=True)]
    home = np.eye(4)
    home[2, 3] = 1.3
    robot = poecal.Robot.from_screws(np.array(screws), home, limits=np.tile([-2.9, 2.9], (7, 1)))
    return poecal.calibrate(robot, poecal.simulate(robot, kind="pose", count=90, seed=5).measurements)


def test_seven_joints_have_branches_where_one_is_held(seven):
    joints = np.random.default_rng(8).uniform(-1.8, 1.8, (60, 7))
    poses = seven.forward_kinematics(joints)
    found = seven.ik(poses, held={"joint3": joints[:, 2]}, limits=False)
    counts = [len(it) for it in found]
    print(f"{min(counts)} to {max(counts)} branches")
    for q, pose, branches in zip(joints, poses, found, strict=True):
        assert apart(seven.forward_kinematics(branches), pose) < 1e-10
        assert np.abs(branches - q).max(axis=1).min() < 1e-7
    one = seven.ik(poses[0], held={"joint3": joints[0, 2]})
    assert 1 <= len(one) <= counts[0] and (np.abs(one) <= 2.9 + 1e-6).all()
    nearest = seven.ik(poses, near=joints + 0.05)
    assert apart(seven.forward_kinematics(nearest), poses) < 1e-10 and apart(nearest, joints) < 0.2


def test_mistakes_about_a_held_joint_are_told(seven, calibration):
    pose = seven.forward_kinematics(np.full(7, 0.3))
    with pytest.raises(ValueError, match=r'near: found None, expected a configuration from which to start, or held={"joint[1-7]": value}'):
        seven.ik(pose)
    with pytest.raises(ValueError, match="held: found joint9, expected a mapping from one of joint1"):
        seven.ik(pose, held={"joint9": 0.1})
    with pytest.raises(ValueError, match="held: found something else"):
        seven.ik(pose, held={"joint3": 0.1, "joint4": 0.1})
    with pytest.raises(ValueError, match=r"held: found an array of shape \(2,\)"):
        seven.ik(pose, held={"joint3": [0.1, 0.2]})
    with pytest.raises(ValueError, match="held: found NaN"):
        seven.ik(pose, held={"joint3": float("nan")})
    with pytest.raises(ValueError, match="held: found a reading that is held, and near"):
        seven.ik(pose, near=np.zeros(7), held={"joint3": 0.1})
    with pytest.raises(ValueError, match="held: found a reading that is held, expected none"):
        calibration.ik(np.eye(4), held={"joint3": 0.1})


def test_many_tips_are_those_of_predict(calibration):
    joints = np.random.default_rng(4).uniform(-2, 2, (1500, 6))
    tips = calibration.forward_kinematics(joints)
    print(f"apart from predict by {apart(tips, calibration.predict(joints)):.1e}")
    # Rounding of some twenty joints, up to 2 m.
    assert tips.shape == (1500, 4, 4) and apart(tips, calibration.predict(joints)) < 1e-14
    assert (calibration.forward_kinematics(joints[7]) == tips[7]).all()
    geometry = calibration.forward_kinematics(joints, model="calibrated")
    assert 1e-6 < apart(geometry, tips) and apart(geometry, calibration.predict(joints, model="calibrated")) < 1e-14
    assert calibration.forward_kinematics(np.zeros((0, 6))).shape == (0, 4, 4)


def test_jacobians_are_the_differences_of_poses(calibration):
    joints = np.random.default_rng(5).uniform(-2, 2, (40, 6))
    jacobians = calibration.jacobian(joints)
    assert jacobians.shape == (40, 6, 6) and (calibration.jacobian(joints[3]) == jacobians[3]).all()
    step, worst = 1e-6, 0.0
    for joint in range(6):
        after, before = (calibration.predict(joints + by * np.eye(6)[joint]) for by in (step, -step))
        turn = (after[:, :3, :3] @ before[:, :3, :3].swapaxes(1, 2)) / (2 * step)
        turn = np.stack([turn[:, i, j] - turn[:, j, i] for i, j in ((2, 1), (0, 2), (1, 0))], axis=1) / 2
        shift = (after - before)[:, :3, 3] / (2 * step)
        worst = max(worst, apart(jacobians[:, :, joint], np.concatenate([shift, turn], axis=1)))
    print(f"off by {worst:.1e}")
    # Rounding of poses over the step.
    assert worst < 3e-9


def test_sag_is_what_weights_do(calibration):
    joints = np.random.default_rng(6).uniform(-2, 2, (200, 6))
    sag = calibration.sag(joints)
    assert sag.shape == (200, 6) and (calibration.sag(joints[9]) == sag[9]).all()
    print(f"up to {np.abs(sag[:, :3]).max():.1e} m and {np.abs(sag[:, 3:]).max():.1e} rad")
    # 2 mrad at the longest lever were planted, a metre from the tip.
    assert 2e-4 < np.linalg.norm(sag[:, :3], axis=1).max() < 2e-2
    assert (calibration.sag(joints, model="calibrated") == 0).all()


def test_threads_find_the_same_bits(calibration, tmp_path):
    calibration.write(tmp_path / "out")
    script = """
import hashlib, sys, numpy as np, poecal
poecal.set_threads(int(sys.argv[2]))
calibration = poecal.Calibration.read(sys.argv[1])
joints = np.random.default_rng(7).uniform(-1, 1, (1300, 6)) + [0, 0.3, 0.3, 0, 1.5, 0]
tips = calibration.forward_kinematics(joints)
found = [tips, calibration.jacobian(joints), calibration.sag(joints), calibration.compensate(joints, nearest=True), calibration.ik(tips, near=joints + 0.1)]
found += calibration.ik(tips[:200])
print(hashlib.sha256(b"".join(it.tobytes() for it in found)).hexdigest())
"""
    hashes = set()
    for threads in (1, 2, 5):
        command = [sys.executable, "-c", script, str(tmp_path / "out/calibration.json"), str(threads)]
        hashes.add(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert len(hashes) == 1 and hashes.pop().strip()


def test_mistakes_are_told(calibration):
    with pytest.raises(ValueError, match="near: found 2 configurations for 1 poses"):
        calibration.ik(np.eye(4), near=np.zeros((2, 6)))
    with pytest.raises(ValueError, match="row 0: found the last row"):
        calibration.ik(np.ones((1, 4, 4)), near=np.zeros(6))
    with pytest.raises(ValueError, match=r"joints: found an array of shape \(3,\), expected shape \(m, 6\)"):
        calibration.compensate(np.zeros(3))
    with pytest.raises(ValueError, match="factors: found heat: 3, expected a mapping from names of factors to numbers: this model"):
        calibration.compensate(np.zeros(6), factors={"heat": 3})
    with pytest.raises(ValueError, match="model: "):
        calibration.ik(np.eye(4), near=np.zeros(6), model="nominal")
    for ask in (calibration.forward_kinematics, calibration.jacobian, calibration.sag):
        with pytest.raises(ValueError, match=r"joints: found an array of shape \(2, 3\), expected shape \(m, 6\)"):
            ask(np.zeros((2, 3)))


def test_arrays_are_of_what_the_controller_counts_where_that_is_said(tmp_path):
    model, made = elbow(), session(count=60, seed=4, error_rotation_deg=0.1, error_position_mm=0.3)
    joints, poses = made.measurements.joints, made.measurements.poses
    # Axes 2 and 3 of this arm turn in the same sense: from the level, the third counts the second too.
    level = np.array([0, 0, 1, 0, 0, 0])
    columns = ",".join([f"J{k}" for k in range(1, 7)] + ["x", "y", "z"] + [f"r{k}" for k in range(9)])
    rows = np.hstack([joints + joints[:, [1]] * level, poses[:, :3, 3], poses[:, :3, :3].reshape(-1, 9)])
    np.savetxt(tmp_path / "session.csv", rows, delimiter=",", header=columns, comments="", fmt="%.15g")
    names = ", ".join(f'"r{k}"' for k in range(9))
    (tmp_path / "map.toml").write_text(f'third_axis = "level"\n[orientation]\nform = "rotation_matrix"\ncolumns = [{names}]\n')
    with pytest.warns(poecal.PoecalWarning, match="took `J1` to `J6`"):
        read = poecal.Measurements.from_csv(tmp_path / "session.csv", model, columns=tmp_path / "map.toml")
    assert apart(read.joints, joints) < 1e-12
    calibration = poecal.calibrate(model, read)
    program = np.random.default_rng(2).uniform(-1, 1, (20, 6)) + [0, 0.3, 0.3, 0, 1.5, 0]
    for call in (calibration.predict, calibration.forward_kinematics, calibration.compensate):
        with pytest.raises(ValueError, match=r'readings: found none, .*joint3 = .*, expected "controller" .* or "model"'):
            call(program)
    as_model = program - program[:, [1]] * level
    assert apart(calibration.predict(program, readings="controller"), calibration.predict(as_model, readings="model")) < 1e-12
    commanded = calibration.compensate(program, readings="controller")
    wanted = calibration.compensate(as_model, readings="model")
    print(f"commands change by up to {np.degrees(apart(commanded, program)):.3f} deg")
    assert apart(commanded - commanded[:, [1]] * level, wanted) < 1e-12 and apart(commanded, program) > 1e-4
    reached = calibration.forward_kinematics(commanded, readings="controller")
    assert apart(reached, calibration.taught().forward_kinematics(as_model)) < 1e-9
    calibration.write(tmp_path / "out")
    again = poecal.Calibration.read(tmp_path / "out/calibration.json")
    assert apart(again.compensate(program, readings="controller"), commanded) < 1e-12


def test_programs_of_fanuc_take_the_third_axis_as_it_is_stated(tmp_path):
    calibration = poecal.calibrate(elbow(), session(count=60, seed=4, error_rotation_deg=0.1, error_position_mm=0.3).measurements)
    start = np.array([10, 20, 30, -20, 40, 15.0])
    numbers = ",".join(f" J{k} = {value:.6f} deg" for k, value in enumerate(start, 1))
    (tmp_path / "job.ls").write_text(f"/PROG JOB\n/MN\n1:J P[1] 100% FINE ;\n/POS\nP[1]{{\n GP1:\n UF : 0, UT : 1,\n{numbers}\n}};\n/END\n")

    def made(**options):
        text, summary = calibration.compensate_program(tmp_path / "job.ls", **options)
        assert summary["corrected"] == 1
        row = text.decode().split("UT : 1,")[1].split("}")[0]
        return np.array([float(it.split("=")[1].split()[0]) for it in row.split(",")])

    level = np.array([0, 0, 1, 0, 0, 0])
    for options, counts in (({}, 0 * level), ({"third_axis": "arm"}, 0 * level), ({"third_axis": "level"}, level)):
        wanted = np.degrees(calibration.compensate(np.radians(start - start[1] * counts)))
        found = made(**options)
        assert apart(found - found[1] * counts, wanted) < 1e-6, options
    with pytest.raises(ValueError, match="third_axis"):
        calibration.compensate_program(tmp_path / "job.ls", language="krl", third_axis="arm")
