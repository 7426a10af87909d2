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
import xacro
import yaml
from program import ELBOW, ROOT, poecal, program
from pxr import Usd, UsdPhysics
from scipy.optimize import least_squares

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


REAL = Path(os.environ.get("POECAL_DATASETS", "nowhere"))
# Robots that were measured: model, measurements, options.
MEASURED = {
    "UR10": ("ur10_tmac/robot.urdf", "ur10_tmac/series_A.csv"),
    "IRB 120": ("irb120_faro/robot.urdf", "irb120_faro/points.csv"),
    "MA1400": ("motoman/robot_left_leica.urdf", "motoman/points_left_small.csv"),
    "Meca500": ("meca500/robot.urdf", "meca500/large160.csv"),
    "positioner": ("positioner_2axis/robot.urdf", "positioner_2axis/poses.csv"),
    "Panda": ("mukca_sockets/panda.urdf", "mukca_sockets/panda_2.csv", "--tip-link", "ball_link", "--socket-distance", "50mm"),
}


@pytest.fixture(scope="module", params=["elbow", "ur10e", *MEASURED])
def calibrated(request, tmp_path_factory):
    """A calibration of a simulated arm, or of one that was measured."""
    folder = tmp_path_factory.mktemp("robot")
    out = folder / "out"
    if request.param in MEASURED:
        model, measurements, *options = MEASURED[request.param]
        if not REAL.is_dir():
            pytest.skip("the data sets are not here: set POECAL_DATASETS")
        poecal("calibrate", REAL / model, REAL / measurements, *options, "--out", out, "--quiet")
        return out / "calibration.json"
    model = ELBOW
    if request.param == "ur10e":
        model = folder / "ur10e.toml"
        model.write_text(dh_model([(0, *row) for row in [(d, a, alpha) for d, a, alpha in UR10E]], "ur10e"))
    poecal("simulate", model, "--kind", "pose", "--count", 60, "--errors", "0.3deg,1mm", "--out", folder / "session", "--quiet")
    poecal("calibrate", model, folder / "session/measurements.csv", "--out", out, "--quiet")
    return out / "calibration.json"


@pytest.fixture(scope="module")
def truth(calibrated):
    """Configurations with the poses of the fit."""
    robot = package.Calibration.read(calibrated).robot
    joints = np.random.default_rng(1).uniform(-2, 2, (CONFIGURATIONS, len(robot.joint_names)))
    return joints, robot.forward_kinematics(joints)


@pytest.fixture(scope="module")
def moves(calibrated):
    """The motion of each joint along or about its z."""
    kinds = [joint["kind"] for joint in json.loads(calibrated.read_text())["joints"]]
    return [(lambda value: about(2, value)) if kind == "revolute" else (lambda value: along(2, value)) for kind in kinds]


def chain(frames, moves):
    """The tip by frames whose z is each joint's axis; the last is the tip's."""

    def place(q):
        found = np.eye(4)
        for frame, move, value in zip(frames, moves, q, strict=False):
            found = found @ frame @ move(value)
        return found @ frames[-1]

    return place


def exported(calibration: Path, form: str, *options) -> str:
    return poecal("export", calibration, "--format", form, *options)


def assert_same(name: str, found, truth, bound=SAME) -> float:
    joints, poses = truth
    worst = max(np.abs(found(q) - pose).max() for q, pose in zip(joints, poses, strict=True))
    print(f"{name}: {worst:.1e} m and parts of a rotation matrix")
    assert worst < bound, name
    return worst


def by_pinocchio(text: str, tip: str, names=None):
    model = pin.buildModelFromXML(text)
    data, frame = model.createData(), model.getFrameId(tip)
    joints = [model.joints[model.getJointId(name)] for name in names] if names else list(model.joints)[1:]

    def place(q):
        values = pin.neutral(model)
        for joint, value in zip(joints, q, strict=True):
            values[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.framesForwardKinematics(model, data, values)
        return data.oMf[frame].homogeneous

    return place


def test_urdf_in_pinocchio(calibrated, truth):
    file = json.loads(calibrated.read_text())
    robot = file["robot"]
    text = exported(calibrated, "urdf")
    place = by_pinocchio(text, robot["tip_link"], [joint["name"] for joint in file["joints"]])
    base = by_pinocchio(text, robot["base_link"])(np.zeros(pin.buildModelFromXML(text).njoints - 1))
    assert_same("urdf", lambda q: np.linalg.inv(base) @ place(q), truth)
    assert text == package.Calibration.read(calibrated).to_urdf()


def test_mjcf_in_mujoco(calibrated, truth, tmp_path):
    tip = json.loads(calibrated.read_text())["robot"]["tip_link"]
    text = exported(calibrated, "mjcf")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)

    def place(q):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = data.site(tip).xmat.reshape(3, 3), data.site(tip).xpos
        return found

    assert_same("mjcf", place, truth)
    (tmp_path / "robot.xml").write_text(text)
    assert_same("mjcf read again", package.Robot.read(tmp_path / "robot.xml").forward_kinematics, truth)


def test_usd_in_usd_core(calibrated, truth, moves, tmp_path):
    path = tmp_path / "robot.usda"
    run = subprocess.run([program(), "export", calibrated, "--format", "usd", "--out", path], capture_output=True, text=True)
    assert run.returncode == 0 and "single precision" in run.stderr
    stage = Usd.Stage.Open(str(path))
    frames, to_world = [], 0
    for prim in stage.GetDefaultPrim().GetChildren():
        joint = UsdPhysics.Joint(prim)
        if not joint:
            continue
        if not joint.GetBody0Rel().GetTargets():
            # The base is not free.
            assert (prim.GetTypeName(), joint.GetBody1Rel().GetTargets()) == ("PhysicsFixedJoint", ["/robot/base"])
            to_world += 1
            continue
        turn = joint.GetLocalRot0Attr().Get()
        frames.append(of_quaternion(joint.GetLocalPos0Attr().Get(), [*turn.GetImaginary(), turn.GetReal()]))
        kind = {"PhysicsRevoluteJoint": UsdPhysics.RevoluteJoint, "PhysicsPrismaticJoint": UsdPhysics.PrismaticJoint}.get(prim.GetTypeName())
        assert prim.GetTypeName() == "PhysicsFixedJoint" or kind(prim).GetAxisAttr().Get() == "Z"
    assert to_world == 1
    place = chain(frames, moves)
    assert_same("usd", place, truth, 1e-6)
    stated = float(run.stderr.replace("\n", " ").split("up to ")[1].split()[0])
    worst = max(np.linalg.norm((place(q) - pose)[:3, 3]) for q, pose in zip(*truth, strict=True))
    # In other configurations than those of the statement, which are within the joints' limits.
    assert worst < 1.5 * stated, f"{worst} m, stated {stated}"


def test_sdf(calibrated, truth, moves, tmp_path):
    text = exported(calibrated, "sdf")
    model = xml.fromstring(text).find("model")
    poses = [link.find("pose") for link in model.findall("link")][1:]
    frames = []
    for pose in poses:
        numbers = [float(part) for part in pose.text.split()]
        is_quaternion = pose.get("rotation_format") == "quat_xyzw"
        frames.append((of_quaternion if is_quaternion else of_rpy)(numbers[:3], numbers[3:]))
    assert [joint.find("axis/xyz").text for joint in model.findall("joint")[:-1]] == ["0 0 1"] * len(moves)
    assert_same("sdf", chain(frames, moves), truth)
    (tmp_path / "robot.sdf").write_text(text)
    assert_same("sdf read again", package.Robot.read(tmp_path / "robot.sdf").forward_kinematics, truth)


@pytest.mark.parametrize("form", ["dh", "mdh", "hayati"])
def test_tables(calibrated, truth, moves, form):
    run = subprocess.run([program(), "export", calibrated, "--format", form], capture_output=True, text=True)
    if run.returncode == 2:
        # Calibrated axes that were parallel are nearly so.
        assert form != "hayati" and "nearly parallel" in run.stderr and "--format hayati" in run.stderr
        return
    table = json.loads(run.stdout)

    def place(q):
        found = of_entry(table["base_from_first"])
        for row, move, value in zip(table["rows"], moves, q, strict=True):
            joint = about(2, row["theta_rad"]) @ along(2, row["d_m"]) @ move(value)
            turn = about(0, row["alpha_rad"])
            if table["convention"] == "modified":
                found = found @ turn @ along(0, row["a_m"]) @ joint
            else:
                found = found @ joint @ along(0, row["a_m"]) @ turn @ about(1, row["beta_rad"])
        return found @ of_entry(table["last_from_tip"])

    assert_same(form, place, truth)


def numbers_of(line: str) -> dict:
    """x: 1, y: 2, … behind the colon of a comment."""
    return {key: float(number) for key, number in (part.split(": ") for part in line.split(", "))}


def test_origins_in_a_xacro(calibrated, truth, tmp_path):
    """The source's own joints with the origins of the file, by names, and its own axes, expanded by xacro."""
    file = json.loads(calibrated.read_text())
    original = file["inputs"].get("urdf")
    if original is None:
        pytest.skip("of a model without URDF: the next test reads it")
    text = exported(calibrated, "origins")
    (tmp_path / "origins.yaml").write_text(text)
    names = yaml.safe_load(text)["origins"]
    robot = xml.fromstring(original["text"])
    robot.set("xmlns:xacro", "http://www.ros.org/wiki/xacro")
    robot.insert(0, xml.Element("xacro:property", name="o", value="${xacro.load_yaml('" + str(tmp_path / "origins.yaml") + "')['origins']}"))
    for joint in robot.findall("joint"):
        if joint.get("name") in names:
            for old in joint.findall("origin"):
                joint.remove(old)
            number = lambda key, name=joint.get("name"): "${o['" + name + "']['" + key + "']}"  # noqa: E731
            at, turn = " ".join(map(number, ["x", "y", "z"])), " ".join(map(number, ["roll", "pitch", "yaw"]))
            xml.SubElement(joint, "origin", xyz=at, rpy=turn)
    source = tmp_path / "robot.xacro"
    xml.ElementTree(robot).write(source)
    expanded = xacro.process_file(str(source)).toxml()
    joints = [joint["name"] for joint in file["joints"]]
    tip, base = (by_pinocchio(expanded, file["robot"][end], joints) for end in ["tip_link", "base_link"])
    tool = [line.split("no place for: ")[1] for line in text.splitlines() if "no place for: " in line]
    stated = numbers_of(tool[0]) if tool else None
    last = of_rpy([stated[key] for key in "xyz"], [stated[key] for key in ["roll", "pitch", "yaw"]]) if stated else np.eye(4)
    assert_same("origins", lambda q: np.linalg.inv(base(q)) @ tip(q) @ last, truth)


@pytest.mark.parametrize("form", ["origins", "ur", "xarm", "franka"])
def test_yaml_in_a_urdf(calibrated, truth, form):
    """The makers' files, put into a URDF as their descriptions do, with the tool that the comment states."""
    if form == "origins" and "urdf" in json.loads(calibrated.read_text())["inputs"]:
        pytest.skip("of a URDF: the test before reads it")
    options = ["--hash", "calib_1"] if form == "ur" else []
    run = subprocess.run([program(), "export", calibrated, "--format", form, *options], capture_output=True, text=True)
    kinds = [joint["kind"] for joint in json.loads(calibrated.read_text())["joints"]]
    counts = {"origins": range(1, 99), "ur": [6], "xarm": [5, 6, 7], "franka": [7]}[form]
    if len(kinds) not in counts or (form != "origins" and "prismatic" in kinds):
        assert run.returncode == 2 and "expected" in run.stderr
        return
    assert run.returncode == 0, run.stderr
    content = yaml.safe_load(run.stdout)
    joints = content if form == "franka" else next(iter(content.values()))
    assert joints.pop("hash", None) == ("calib_1" if form == "ur" else None)
    origins = [origin["kinematic"] if form == "franka" else origin for origin in joints.values()]
    assert {type(number) for origin in origins for number in origin.values()} == {float}
    none = dict.fromkeys(["x", "y", "z", "roll", "pitch", "yaw"], 0.0)
    if form != "franka":
        tool = [line.split("no place for: ")[1] for line in run.stdout.splitlines() if "no place for: " in line]
        origins.append(numbers_of(tool[0]) if tool else none)
    # Fixed joints before the first one, as the comment states.
    before = [line.split("which is at ")[1].split(" in ")[0] for line in run.stdout.splitlines() if "which is at " in line]
    origins.insert(0, numbers_of(before[0]) if before else none)
    robot = xml.Element("robot", name="made")
    xml.SubElement(robot, "link", name="link0")
    types = ["fixed", *({"revolute": "continuous", "prismatic": "prismatic"}[kind] for kind in kinds), "fixed"]
    for k, (origin, kind) in enumerate(zip(origins, types, strict=True)):
        xml.SubElement(robot, "link", name=f"link{k + 1}")
        joint = xml.SubElement(robot, "joint", name=f"joint{k + 1}", type=kind)
        xml.SubElement(joint, "parent", link=f"link{k}")
        xml.SubElement(joint, "child", link=f"link{k + 1}")
        numbers = [repr(origin[key]) for key in ["x", "y", "z", "roll", "pitch", "yaw"]]
        xml.SubElement(joint, "origin", xyz=" ".join(numbers[:3]), rpy=" ".join(numbers[3:]))
        xml.SubElement(joint, "axis", xyz="0 0 1")
        xml.SubElement(joint, "limit", lower="-9", upper="9", effort="0", velocity="0")
    assert_same(form, by_pinocchio(xml.tostring(robot, encoding="unicode"), f"link{len(origins)}"), truth)


def test_csv(calibrated, truth, moves):
    rows = [line.split(",") for line in exported(calibrated, "csv").splitlines()[1:]]
    frames = [of_rpy([float(cell) for cell in row[2:5]], [float(cell) for cell in row[5:]]) for row in rows]
    assert_same("csv", chain(frames, moves), truth)


def test_poe(calibrated, truth):
    file = json.loads(exported(calibrated, "poe"))

    def place(q):
        found = np.eye(4)
        for joint, value in zip(file["joints"], q, strict=True):
            found = found @ pin.exp6(np.array([*joint["v"], *joint["w"]]) * value).homogeneous
        return found @ of_entry(file["home"])

    assert_same("poe", place, truth)


def test_offsets_leave_what_they_state(calibrated):
    """The nominal robot with offsets, base and tool of the file, against the fit: the remainder is stated to 1 %, in configurations of its own."""
    file = json.loads(exported(calibrated, "offsets"))
    calibration = package.Calibration.read(calibrated)
    nominal, actual = calibration.nominal, calibration.robot
    limits = np.array([[it["sampled_min"], it["sampled_max"]] for it in calibration.to_dict()["coverage"]])
    joints = np.random.default_rng(5).uniform(limits[:, 0], limits[:, 1], (100_000, len(limits)))
    offsets = [np.deg2rad(it["offset_deg"]) if "offset_deg" in it else it["offset_mm"] / 1e3 for it in file["joints"]]
    found = of_entry(file["base_motion"]) @ nominal.forward_kinematics(joints + offsets) @ of_entry(file["tool_motion"])
    apart = found[:, :3, 3] - actual.forward_kinematics(joints)[:, :3, 3]
    goal = actual.forward_kinematics(joints)
    turn = np.array([pin.log3(one[:3, :3] @ other[:3, :3].T) for one, other in zip(found[:20000], goal[:20000], strict=True)])
    rms_mm, rms_deg = 1e3 * np.sqrt((apart**2).sum(axis=1).mean()), np.degrees(np.sqrt((turn**2).sum(axis=1).mean()))
    stated = file["remains"]["rms_mm"]
    print(f"offsets: {rms_mm:.5f} mm and {rms_deg:.5f} deg left, stated {stated:.5f} and {file['remains']['rms_deg']:.5f}; without offsets {file['without_offsets']['rms_mm']:.4f} mm")
    # For 10,000 configurations the mean square is known to 1 to 2 %.
    assert abs(rms_mm / stated - 1) < 0.02 and abs(rms_deg / file["remains"]["rms_deg"] - 1) < 0.02
    # The other command has the same result.
    told = package.offsets(nominal, calibration).to_dict()
    assert [it["joint"] for it in told["joints"]] == [it["joint"] for it in file["joints"]]
    differ = [abs(a["offset_deg"] - b["offset_deg"]) for a, b in zip(told["joints"], file["joints"], strict=True) if "offset_deg" in b]
    print(f"offsets: poecal offsets differs by {max(differ):.1e} deg at most")
    assert max(differ) < 1e-6 and abs(told["predictions"]["with_offsets"]["position_rms_mm"] - stated) < 1e-6
    # No other offsets, base and tool do better: SciPy from there, in some of the configurations.
    some, goal = joints[:3000], goal[:3000]
    before = nominal.forward_kinematics
    tool_of_file = of_entry(file["tool_motion"])

    def apart_by(x):
        base, tool = pin.exp6(x[:6]).homogeneous @ of_entry(file["base_motion"]), tool_of_file @ pin.exp6(x[6:12]).homogeneous
        poses = base @ before(some + offsets + x[12:]) @ tool
        # Turns count at a tenth of a metre; chords instead of angles.
        turned = 0.1 / np.sqrt(2) * (poses[:, :3, :3] - goal[:, :3, :3])
        return np.concatenate([(poses[:, :3, 3] - goal[:, :3, 3]).ravel(), turned.ravel()])

    start = np.zeros(12 + len(limits))
    best = least_squares(apart_by, start, x_scale="jac")
    gained = 1 - np.sqrt(best.cost / (0.5 * (apart_by(start) ** 2).sum()))
    print(f"offsets: SciPy gains {gained:.1e} of it")
    # Its configurations are others: 12 + n unknowns from 18,000 numbers.
    assert gained < 0.005


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
