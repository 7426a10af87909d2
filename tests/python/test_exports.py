"""Exported forms against readers from outside: Pinocchio (URDF, and the makers' YAML put into a URDF), MuJoCo, usd-core, and tables by NumPy."""

import json
import os
import subprocess
import xml.etree.ElementTree as xml
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yaml
from program import ELBOW, ROOT, poecal, program
from pxr import Usd, UsdPhysics

import poecal as package

# Rounding of a dozen products of poses of some metres; MuJoCo normalises its quaternions once more.
SAME = 1e-9
CONFIGURATIONS = 200

# Axes as Universal Robots' arms have them: three are parallel.
UR10E = [(0.1807, 0, np.pi / 2), (0, -0.6127, 0), (0, -0.57155, 0), (0.17415, 0, np.pi / 2), (0.11985, 0, -np.pi / 2), (0.11655, 0, 0)]


def about(axis: int, angle: float) -> np.ndarray:
    found, (s, c) = np.eye(4), (np.sin(angle), np.cos(angle))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found[i, i] = found[j, j] = c
    found[j, i], found[i, j] = s, -s
    return found


def along(axis: int, distance: float) -> np.ndarray:
    found = np.eye(4)
    found[axis, 3] = distance
    return found


def of_rpy(xyz, rpy) -> np.ndarray:
    found = about(2, rpy[2]) @ about(1, rpy[1]) @ about(0, rpy[0])
    found[:3, 3] = xyz
    return found


def of_quaternion(xyz, xyzw) -> np.ndarray:
    x, y, z, w = np.array(xyzw, dtype=float) / np.linalg.norm(xyzw)
    found = np.eye(4)
    found[:3, :3] = pin.Quaternion(w, x, y, z).matrix()
    found[:3, 3] = xyz
    return found


def of_entry(entry: dict) -> np.ndarray:
    return of_quaternion(entry["position_m"], entry["quaternion_xyzw"])


def dh_model(rows, name: str) -> str:
    """A TOML model of Denavit and Hartenberg's rows theta, d, a, alpha."""
    lines = ["poecal_robot = 1", f'name = "{name}"', 'length_unit = "m"', 'angle_unit = "rad"', 'convention = "standard_dh"']
    for k, (theta, d, a, alpha) in enumerate(rows):
        numbers = f"theta = {float(theta)!r}, d = {float(d)!r}, a = {float(a)!r}, alpha = {float(alpha)!r}"
        lines.append(f'[[joint]]\nname = "joint{k + 1}"\ntype = "revolute"\n{numbers.replace(", ", chr(10))}\nlimits = [-3.1, 3.1]')
    return "\n".join(lines) + "\n"


def by_dh(rows, q) -> np.ndarray:
    found = np.eye(4)
    for (theta, d, a, alpha), value in zip(rows, q, strict=True):
        found = found @ about(2, theta + value) @ along(2, d) @ along(0, a) @ about(0, alpha)
    return found


@pytest.fixture(scope="module", params=["elbow", "ur10e"])
def calibrated(request, tmp_path_factory):
    """A folder with a calibration of a simulated arm."""
    folder = tmp_path_factory.mktemp(request.param)
    model = ELBOW
    if request.param == "ur10e":
        model = folder / "ur10e.toml"
        model.write_text(dh_model([(0, *row) for row in [(d, a, alpha) for d, a, alpha in UR10E]], "ur10e"))
    poecal("simulate", model, "--kind", "pose", "--count", 60, "--errors", "0.3deg,1mm", "--out", folder / "session", "--quiet")
    poecal("calibrate", model, folder / "session/measurements.csv", "--out", folder / "out", "--quiet")
    return folder / "out/calibration.json"


@pytest.fixture(scope="module")
def truth(calibrated):
    """Configurations with the poses of the fit."""
    robot = package.Calibration.read(calibrated).robot
    joints = np.random.default_rng(1).uniform(-2, 2, (CONFIGURATIONS, 6))
    return joints, robot.forward_kinematics(joints)


def exported(calibration: Path, form: str, *options) -> str:
    return poecal("export", calibration, "--format", form, *options)


def assert_same(name: str, found, truth, bound=SAME) -> float:
    joints, poses = truth
    worst = max(np.abs(found(q) - pose).max() for q, pose in zip(joints, poses, strict=True))
    print(f"{name}: {worst:.1e} m and parts of a rotation matrix")
    assert worst < bound, name
    return worst


def by_pinocchio(text: str, tip: str):
    model = pin.buildModelFromXML(text)
    data, frame = model.createData(), model.getFrameId(tip)

    def place(q):
        values = pin.neutral(model)
        for joint, value in zip(model.joints[1:], q, strict=True):
            values[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.framesForwardKinematics(model, data, values)
        return data.oMf[frame].homogeneous

    return place


def test_urdf_in_pinocchio(calibrated, truth):
    tip = json.loads(calibrated.read_text())["robot"]["tip_link"]
    text = exported(calibrated, "urdf")
    assert_same("urdf", by_pinocchio(text, tip), truth)
    assert text == package.Calibration.read(calibrated).to_urdf()


def test_mjcf_in_mujoco(calibrated, truth):
    tip = json.loads(calibrated.read_text())["robot"]["tip_link"]
    model = mujoco.MjModel.from_xml_string(exported(calibrated, "mjcf"))
    data = mujoco.MjData(model)

    def place(q):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = data.site(tip).xmat.reshape(3, 3), data.site(tip).xpos
        return found

    assert_same("mjcf", place, truth)


def test_usd_in_usd_core(calibrated, truth, tmp_path):
    path = tmp_path / "robot.usda"
    run = subprocess.run([program(), "export", calibrated, "--format", "usd", "--out", path], capture_output=True, text=True)
    assert run.returncode == 0 and "single precision" in run.stderr
    stage = Usd.Stage.Open(str(path))
    frames = []
    for prim in stage.GetDefaultPrim().GetChildren():
        joint = UsdPhysics.Joint(prim)
        if not joint:
            continue
        turn = joint.GetLocalRot0Attr().Get()
        frames.append(of_quaternion(joint.GetLocalPos0Attr().Get(), [*turn.GetImaginary(), turn.GetReal()]))
        assert prim.GetTypeName() == "PhysicsFixedJoint" or UsdPhysics.RevoluteJoint(prim).GetAxisAttr().Get() == "Z"

    def place(q):
        found = np.eye(4)
        for frame, value in zip(frames, [*q, 0.0], strict=True):
            found = found @ frame @ about(2, value)
        return found

    assert_same("usd", place, truth, 1e-6)
    stated = float(run.stderr.replace("\n", " ").split("up to ")[1].split()[0])
    worst = max(np.linalg.norm((place(q) - pose)[:3, 3]) for q, pose in zip(*truth, strict=True))
    # Of other configurations than those of the statement, which are within the joints' limits.
    assert worst < 1.5 * stated, f"{worst} m, stated {stated}"


def test_sdf(calibrated, truth):
    model = xml.fromstring(exported(calibrated, "sdf")).find("model")
    poses = [link.find("pose") for link in model.findall("link")][1:]
    frames = []
    for pose in poses:
        numbers = [float(part) for part in pose.text.split()]
        is_quaternion = pose.get("rotation_format") == "quat_xyzw"
        frames.append((of_quaternion if is_quaternion else of_rpy)(numbers[:3], numbers[3:]))
    assert [joint.find("axis/xyz").text for joint in model.findall("joint")[:-1]] == ["0 0 1"] * 6

    def place(q):
        found = np.eye(4)
        for frame, value in zip(frames, [*q, 0.0], strict=True):
            found = found @ frame @ about(2, value)
        return found

    assert_same("sdf", place, truth)


@pytest.mark.parametrize("form", ["dh", "mdh", "hayati"])
def test_tables(calibrated, truth, form):
    run = subprocess.run([program(), "export", calibrated, "--format", form], capture_output=True, text=True)
    if run.returncode == 2:
        # Calibrated axes that were parallel are nearly so.
        assert form != "hayati" and "nearly parallel" in run.stderr and "--format hayati" in run.stderr
        return
    table = json.loads(run.stdout)

    def place(q):
        found = of_entry(table["base_from_first"])
        for row, value in zip(table["rows"], q, strict=True):
            joint = about(2, row["theta_rad"] + value) @ along(2, row["d_m"])
            turn = about(0, row["alpha_rad"])
            if table["convention"] == "modified":
                found = found @ turn @ along(0, row["a_m"]) @ joint
            else:
                found = found @ joint @ along(0, row["a_m"]) @ turn @ about(1, row["beta_rad"])
        return found @ of_entry(table["last_from_tip"])

    assert_same(form, place, truth)


@pytest.mark.parametrize("form", ["origins", "ur", "xarm"])
def test_yaml_in_a_urdf(calibrated, truth, form):
    """The makers' files, put into a URDF as their descriptions do, with the tool that the comment states."""
    options = ["--hash", "calib_1"] if form == "ur" else []
    text = exported(calibrated, form, *options)
    content = yaml.safe_load(text)
    joints = next(iter(content.values()))
    assert joints.pop("hash", None) == ("calib_1" if form == "ur" else None)
    assert [type(number) for origin in joints.values() for number in origin.values()] == [float] * 36
    tool = [line.split("no place for: ")[1] for line in text.splitlines() if "no place for: " in line]
    stated = dict(part.split(": ") for part in tool[0].split(", ")) if tool else {}
    origins = [*joints.values(), {key: float(stated.get(key, 0)) for key in ["x", "y", "z", "roll", "pitch", "yaw"]}]
    robot = xml.Element("robot", name="made")
    xml.SubElement(robot, "link", name="link0")
    for k, origin in enumerate(origins):
        xml.SubElement(robot, "link", name=f"link{k + 1}")
        joint = xml.SubElement(robot, "joint", name=f"joint{k + 1}", type="continuous" if k < 6 else "fixed")
        xml.SubElement(joint, "parent", link=f"link{k}")
        xml.SubElement(joint, "child", link=f"link{k + 1}")
        numbers = [repr(origin[key]) for key in ["x", "y", "z", "roll", "pitch", "yaw"]]
        xml.SubElement(joint, "origin", xyz=" ".join(numbers[:3]), rpy=" ".join(numbers[3:]))
        xml.SubElement(joint, "axis", xyz="0 0 1")
    assert_same(form, by_pinocchio(xml.tostring(robot, encoding="unicode"), "link7"), truth)


def test_poe(calibrated, truth):
    file = json.loads(exported(calibrated, "poe"))

    def place(q):
        found = np.eye(4)
        for joint, value in zip(file["joints"], q, strict=True):
            found = found @ pin.exp6(np.array([*joint["v"], *joint["w"]]) * value).homogeneous
        return found @ of_entry(file["home"])

    assert_same("poe", place, truth)


def test_factory_calibrations_survive():
    """Real factory calibrations of Universal Robots, whose rows of Denavit and Hartenberg have offsets of hundreds of metres."""
    folder = Path(os.environ.get("POECAL_DATASETS", "nowhere")) / "ur_factory"
    if not folder.is_dir():
        pytest.skip("the data sets are not here: set POECAL_DATASETS")
    read = lambda name: [line.split(",") for line in (folder / name).read_text().splitlines()[1:]]  # noqa: E731
    nominal = {(model, joint): np.array(numbers, dtype=float) for model, joint, *numbers in read("nominal_dh.csv")}
    robots = {}
    for robot, model, joint, *delta in read("delta_dh.csv"):
        a, alpha, d, theta = nominal[model, joint] + np.array(delta, dtype=float)
        robots.setdefault(robot, []).append((theta, d, a, alpha))
    for robot, rows in robots.items():
        model = ROOT / f"target/{robot}.toml"
        model.write_text(dh_model(rows, robot))
        joints = np.random.default_rng(2).uniform(-3, 3, (CONFIGURATIONS, 6))
        truth = joints, np.array([by_dh(rows, q) for q in joints])
        run = subprocess.run([program(), "export", model, "--format", "ur", "--hash", "calib_1"], capture_output=True, text=True)
        assert run.returncode == 0, run.stderr
        origins = list(yaml.safe_load(run.stdout)["kinematics"].values())[:-1]
        tool = [line.split("no place for: ")[1] for line in run.stdout.splitlines() if "no place for: " in line]
        origins += [{key: float(number) for key, number in (part.split(": ") for part in tool[0].split(", "))}] if tool else []

        def place(q, origins=origins):
            found = np.eye(4)
            for origin, value in zip(origins, [*q, 0.0], strict=False):
                xyz, rpy = [origin[key] for key in "xyz"], [origin[key] for key in ["roll", "pitch", "yaw"]]
                found = found @ of_rpy(xyz, rpy) @ about(2, value)
            return found

        assert_same(robot, place, truth)
        lengths = [abs(origin[key]) for origin in origins for key in "xyz"]
        assert max(lengths) < 2, "no origin is far away"
