"""Forward kinematics against Pinocchio: of models as read, and of a calibrated URDF."""

import xml.etree.ElementTree as xml

import numpy as np
import pinocchio as pin
import poecal as package
import pytest
from program import ELBOW, URDFS, poecal, predict, simulated_session, write_table

# Rounding of a dozen products of poses of some metres.
TOLERANCE_M = 1e-12
TOLERANCE_RAD = 1e-12
CONFIGURATIONS = 50


def relations(text: str) -> dict:
    """Joint -> (leader, multiplier, offset) of mimic joints. Pinocchio takes every joint's own value."""
    found = {}
    for joint in xml.fromstring(text).findall("joint"):
        for mimic in joint.findall("mimic"):
            numbers = float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0))
            found[joint.get("name")] = (mimic.get("joint"), *numbers)
    return found


def leader_of(joint: str, mimics: dict) -> str:
    return leader_of(mimics[joint][0], mimics) if joint in mimics else joint


def value_of(joint: str, readings: dict, mimics: dict) -> float:
    if joint not in mimics:
        return readings[joint]
    leader, multiplier, offset = mimics[joint]
    return multiplier * value_of(leader, readings, mimics) + offset


class PinocchioChain:
    """A chain from `base_link` to a tip."""

    def __init__(self, text: str, tip: str):
        self.model = pin.buildModelFromXML(text)
        self.data = self.model.createData()
        self.mimics = relations(text)
        self.tip, self.base = self.model.getFrameId(tip), self.model.getFrameId("base_link")
        supports = self.model.supports[self.model.frames[self.tip].parentJoint]
        self.readings = sorted({leader_of(self.model.names[i], self.mimics) for i in supports if i > 0})

    def tip_pose(self, readings: dict) -> pin.SE3:
        q = pin.neutral(self.model)
        for i in range(1, self.model.njoints):
            name, joint = self.model.names[i], self.model.joints[i]
            if leader_of(name, self.mimics) in readings:
                theta = value_of(name, readings, self.mimics)
                q[joint.idx_q : joint.idx_q + joint.nq] = [theta] if joint.nq == 1 else [np.cos(theta), np.sin(theta)]
        pin.framesForwardKinematics(self.model, self.data, q)
        return self.data.oMf[self.base].actInv(self.data.oMf[self.tip])

    def assert_equals(self, predicted: np.ndarray, joints: dict) -> None:
        worst_m = worst_rad = 0.0
        for row, pose in enumerate(predicted):
            expected = self.tip_pose({name: values[row] for name, values in joints.items()})
            rotation = pin.Quaternion(*pose[[6, 3, 4, 5]]).toRotationMatrix()
            worst_m = max(worst_m, np.linalg.norm(pose[:3] - expected.translation))
            worst_rad = max(worst_rad, np.linalg.norm(pin.log3(rotation.T @ expected.rotation)))
        print(f"largest differences: {worst_m:.1e} m, {worst_rad:.1e} rad")
        assert worst_m <= TOLERANCE_M and worst_rad <= TOLERANCE_RAD


def tip_of(path) -> str:
    """The tip that the program itself finds."""
    return poecal("export", path, "--format", "toml", "--quiet").split('tip_link = "')[1].split('"')[0]


@pytest.mark.parametrize("path", sorted(URDFS.glob("*.urdf")), ids=lambda path: path.stem)
def test_predictions_of_a_urdf_are_pinocchios(path, tmp_path):
    chain = PinocchioChain(path.read_text(), tip_of(path))
    rng = np.random.default_rng(1)
    joints = {name: rng.uniform(-2, 2, CONFIGURATIONS) for name in chain.readings}
    write_table(tmp_path / "joints.csv", joints)
    chain.assert_equals(predict(path, tmp_path / "joints.csv", "--quiet"), joints)


def test_there_are_ten_urdfs():
    assert len(list(URDFS.glob("*.urdf"))) == 10


def test_the_calibrated_urdf_in_pinocchio_is_the_calibration(tmp_path):
    rng = np.random.default_rng(2)
    limits = {1: (-3, 3), 2: (-1.8, 3), 3: (-4, 1.4), 4: (-3, 3), 5: (-0.6, 3.8), 6: (-6, 6)}
    joints = {f"joint{i}": rng.uniform(*limits[i], CONFIGURATIONS) for i in limits}
    measurements, _ = simulated_session(tmp_path, joints)
    out = tmp_path / "out"
    poecal("calibrate", ELBOW, measurements, "--out", out)
    chain = PinocchioChain((out / "calibrated.urdf").read_text(), "tool")
    assert chain.readings == list(joints)
    chain.assert_equals(predict(out / "calibration.json", tmp_path / "joints.csv"), joints)


def test_jacobians_of_the_calibrated_robot_are_pinocchios(tmp_path):
    rng = np.random.default_rng(3)
    joints = {f"joint{i}": rng.uniform(-2, 2, CONFIGURATIONS) for i in range(1, 7)}
    measurements, _ = simulated_session(tmp_path, joints)
    out = tmp_path / "out"
    poecal("calibrate", ELBOW, measurements, "--out", out)
    calibration = package.Calibration.read(out / "calibration.json")
    chain = PinocchioChain((out / "calibrated.urdf").read_text(), "tool")
    rows = np.stack([joints[name] for name in calibration.robot.reading_names], axis=1)
    worst = 0.0
    for q, jacobian in zip(rows, calibration.jacobian(rows, model="calibrated"), strict=True):
        found = pin.computeFrameJacobian(chain.model, chain.data, q, chain.tip, pin.LOCAL_WORLD_ALIGNED)
        pin.framesForwardKinematics(chain.model, chain.data, q)
        turn = chain.data.oMf[chain.base].rotation.T
        worst = max(worst, np.abs(np.vstack([turn @ found[:3], turn @ found[3:]]) - jacobian).max())
    print(f"largest difference of Jacobians: {worst:.1e}")
    assert worst <= TOLERANCE_M
