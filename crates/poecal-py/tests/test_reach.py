"""Inverse kinematics and compensation."""

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
    meant = calibration.nominal.forward_kinematics(joints)
    commanded = calibration.compensate(joints)
    assert commanded.shape == joints.shape
    reached = poses_of(calibration, commanded)
    print(f"without correction {np.linalg.norm((poses_of(calibration, joints) - reached)[:, :3, 3], axis=1).max() * 1e3:.2f} mm")
    assert apart(reached, meant) < 1e-10
    assert 1e-4 < np.median(np.abs(commanded - joints)) < 0.05
    assert apart(calibration.compensate(joints[3]), commanded[3]) < 1e-10
    assert calibration.compensate(joints[3]).shape == (6,)


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
