"""Models in forms of simulators and makers, against readers from outside."""

import json
import subprocess
from pathlib import Path

import mujoco
import numpy as np
import pytest
from program import ELBOW, poecal, program
from test_exports import SAME, UR10E, about, assert_same, by_dh, of_rpy

import poecal as package

MODELS = Path(__file__).parent / "models"
CONFIGURATIONS = 200

# Additions of a maker's calibration to the rows of UR10E: theta, a, d, alpha; axes that are nearly parallel meet far away.
DELTAS = {
    "delta_theta": [-8.1e-05, -0.1036, 0.673, -0.57, -4.5e-05, 9.7e-07],
    "delta_a": [-1.6e-04, 3.0e-03, 0.0916, -9.6e-05, -2.9e-05, 0],
    "delta_d": [5.0e-04, 11.198, -92.527, 81.328, -2.1e-04, -1.2e-04],
    "delta_alpha": [-3.2e-04, -5.65e-03, -3.79e-03, -1.07e-03, 9.9e-04, 0],
}


def placed(robot):
    return lambda q: robot.forward_kinematics(q)


def test_mjcf_is_read_as_mujoco_reads_it():
    """Units, orders of angles, classes of defaults, frames, references, joints beside their body and two in one, a follower."""
    path = MODELS / "arm.xml"
    robot = package.Robot.read(path)
    assert robot.joint_names == ["lift", "pan", "tilt", "roll", "turn"]
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    at = {name: model.joint(name).qposadr[0] for name in robot.joint_names}
    tilt, turn = at["tilt"], at["turn"]

    def place(q):
        data.qpos[[at[name] for name in robot.reading_names]] = q
        data.qpos[turn] = model.qpos0[turn] + 0.1 - 0.5 * (data.qpos[tilt] - model.qpos0[tilt])
        mujoco.mj_kinematics(model, data)
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = data.site("tool").xmat.reshape(3, 3), data.site("tool").xpos
        return found

    joints = np.random.default_rng(1).uniform(-2, 2, (CONFIGURATIONS, len(robot.reading_names)))
    assert_same("mjcf", place, (joints, robot.forward_kinematics(joints)))
    text = json.loads(poecal("check", path, "--json"))
    assert text["model"]["form"] == "MJCF"
    limits = {joint["name"]: joint.get("limits") for joint in text["model"]["joints"]}
    for name, found in limits.items():
        expected = model.joint(name).range if model.joint(name).limited else None
        assert (found is None) == (expected is None), name
        if found is not None:
            assert np.allclose([found["lower"], found["upper"]] if isinstance(found, dict) else found, expected, atol=1e-12), name


GEOM = "<geom size='.01' mass='1'/>"


def two_bodies(top="", first="<joint name='j1' axis='0 0 1'/>", place="pos='1 0 0'", second="<joint name='j2' axis='0 1 0'/>", end=None, tail=""):
    """A model of two bodies `a` and `b` with their joints, and a site `tool` in the second."""
    end = "<site name='tool' pos='.1 .2 .3'/>" if end is None else end
    bodies = f"<body name='a' pos='0 0 1'>{GEOM}{first}<body name='b' {place}>{GEOM}{second}{end}</body></body>"
    return f"<mujoco>{top}<worldbody>{bodies}</worldbody>{tail}</mujoco>"


def follower(words):
    return f"<equality><joint joint1='j2' joint2='j1' {words}/></equality>"


TURNED = "<joint name='j2' axis='1 .2 0' pos='.1 .2 .3' ref='13'/><joint name='s' type='slide' axis='.1 .3 2' ref='.2' range='-1 1'/>"
# Name: model, and the site or body that is the tip.
ODD_MJCF = {
    "joint in a frame": (two_bodies(second="<frame pos='.1 .2 .3' euler='10 20 30'><joint name='j2' axis='0 1 0' pos='.1 0 0'/></frame>"), "tool"),
    "joint in a frame behind another": (
        two_bodies(second="<joint name='j2' axis='1 0 0'/><frame pos='.1 .2 .3' euler='10 20 30'><joint name='j3' axis='0 1 0' pos='.1 0 0'/></frame>"),
        "tool",
    ),
    "tool against z": (two_bodies(end="<site name='tool' zaxis='0 0 -1'/>"), "tool"),
    "tool almost against z": (two_bodies(end="<site name='tool' zaxis='1e-3 -2e-3 -1'/>"), "tool"),
    "joint beside the body that is the tip": (two_bodies(second="<joint name='j2' axis='0 1 0' pos='.1 0 .05'/>", end=""), "b"),
    "joint beside a body before": (two_bodies(first="<joint name='j1' axis='1 0 1' pos='.1 0 .05'/>"), "tool"),
    "several joints in a body": (two_bodies(second=TURNED), "tool"),
    "rotation of a default": (two_bodies("<default><site quat='1 .2 .3 .4'/></default>", end="<site name='tool' euler='10 20 30'/>"), "tool"),
    "rotation of a default alone": (two_bodies("<default><site axisangle='0 0 1 30'/></default>", end="<site name='tool'/>"), "tool"),
    "defaults in two parts": (two_bodies("<default><joint pos='.1 0 0'/></default><default><joint pos='.2 0 0'/></default>"), "tool"),
    "class of the first part": (
        two_bodies(
            "<default><default class='k'><joint axis='1 0 0'/></default></default><default><joint pos='.2 0 0'/></default>",
            second="<joint name='j2' class='k'/>",
        ),
        "tool",
    ),
    "site alone in a frame": (two_bodies(end="<frame pos='.1 .2 .3' euler='10 20 30'><site name='tool'/></frame>"), "tool"),
    "body named as another's link": (two_bodies(first="<joint name='x' axis='0 0 1'/><joint name='y' axis='0 1 0'/>", end="").replace("'b'", "'a_1'"), "a_1"),
    "joint named as another's": (two_bodies(first="<joint/>", second="<joint name='a_joint' axis='1 0 0'/>"), "tool"),
    "joint named as a mount": (two_bodies(first="", second="<joint name='a_mount' axis='1 0 0'/>"), "tool"),
    "coefficients that are left out": (two_bodies(tail=follower("polycoef='0.1'")), "tool"),
    "follower of a line": (two_bodies(tail=follower("polycoef='0.1 -2'")), "tool"),
    "follower that does not count": (two_bodies("<default><equality active='false'/></default>", tail=follower("")), "tool"),
    "joint held at a value": (two_bodies(tail="<equality><joint joint1='j2' polycoef='.3 0 0 0 0'/></equality>"), "tool"),
    "axes in mixed order": (two_bodies("<compiler eulerseq='xYz' angle='radian'/>", place="euler='.1 .2 .3'"), "tool"),
}


@pytest.mark.parametrize("name", ODD_MJCF)
def test_odd_mjcf_is_read_as_mujoco_reads_it(name, tmp_path):
    text, tip = ODD_MJCF[name]
    path = tmp_path / "arm.xml"
    path.write_text(text)
    # A site is the tip by itself, and so is the last body.
    robot = package.Robot.read(path, tip_link=tip if tip == "a_1" else None)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    readings = np.random.default_rng(4).uniform(-2, 2, (20, len(robot.reading_names)))
    names = [model.joint(index).name for index in range(model.njnt)]
    adr = [model.jnt_qposadr[index] for index in range(model.njnt)]
    places = []
    for q in readings:
        data.qpos[:] = model.qpos0
        for reading, value in zip(robot.reading_names, q, strict=True):
            # A joint without a name is the only one of a model here.
            data.qpos[adr[names.index(reading if reading in names else "")]] = value
        for index in range(model.neq):
            if model.eq_active0[index]:
                follows, leader = model.eq_obj1id[index], model.eq_obj2id[index]
                moved = data.qpos[adr[leader]] - model.qpos0[adr[leader]] if leader >= 0 else 0.0
                data.qpos[adr[follows]] = model.qpos0[adr[follows]] + np.polyval(model.eq_data[index][4::-1], moved)
        mujoco.mj_kinematics(model, data)
        thing = data.site(tip) if tip == "tool" else data.body(tip)
        place = np.eye(4)
        place[:3, :3], place[:3, 3] = thing.xmat.reshape(3, 3), thing.xpos
        places.append(place)
    assert_same(name, placed(robot), (readings, np.array(places)))


REFUSED_MJCF = {
    "undefined class": (two_bodies(second="<joint name='j2' class='k'/>"), "found the class `k`, expected one that a <default> has"),
    "undefined class of what is inside": (two_bodies(place="childclass='k'"), "found the class `k`"),
    "class twice": (two_bodies("<default><default class='k'/><default class='k'/></default>"), "found the class `k` a second time"),
    "two rotations": (two_bodies(end="<site name='tool' euler='1 2 3' quat='1 0 0 0'/>"), "found `quat` and `euler` in <site> `tool`, expected one of them"),
    "site between points": (two_bodies(end="<site name='tool' type='capsule' size='.01' fromto='0 0 0 1 1 1'/>"), "found `fromto` of <site> `tool`"),
    "limits in words": (two_bodies(second="<joint name='j2' limited='yes' range='0 1'/>"), 'found limited="yes" of <joint> `j2`, expected true, false or auto'),
    "setting in words": (two_bodies("<compiler autolimits='maybe'/>"), 'found autolimits="maybe" in <compiler>, expected true or false'),
    "coefficient in words": (two_bodies(tail=follower("polycoef='0 1 0 0 x'")), 'found polycoef="0 1 0 0 x", expected up to 5 numbers'),
    "unknown leader": (two_bodies(tail="<equality><joint joint1='j2' joint2='jx'/></equality>"), 'found joint2="jx", expected the name of a joint'),
    "curve": (two_bodies(tail=follower("polycoef='0 1 .3 0 0'")), "`j2`"),
    "part of a model": ("<mujocoinclude><worldbody/></mujocoinclude>", "found a part of a model (<mujocoinclude>)"),
}


@pytest.mark.parametrize("name", REFUSED_MJCF)
def test_mjcf_that_says_something_else_is_refused(name, tmp_path):
    text, sentence = REFUSED_MJCF[name]
    path = tmp_path / "arm.xml"
    path.write_text(text)
    with pytest.raises(package.InputError) as raised:
        package.Robot.read(path)
    print(raised.value)
    assert sentence in str(raised.value)


def test_sdf_is_read_as_drake_reads_it():
    """Configurations of pan, lift and wrist, and the tool in the world by Drake 1.51.1 of the same file (its reader is Gazebo's own)."""
    robot = package.Robot.read(MODELS / "arm.sdf", tip_link="tool")
    rows = np.array(json.loads((MODELS / "arm.sdf.json").read_text()))
    joints = {name: column for name, column in zip(["pan", "lift", "wrist"], rows[:, :3].T, strict=True)}
    found = robot.forward_kinematics(np.column_stack([joints[name] for name in robot.reading_names]))
    worst = np.abs(found[:, :3].reshape(len(rows), 12) - rows[:, 3:]).max()
    print(f"sdf: {worst:.1e}")
    assert worst < SAME


def controller_files(folder: Path, deltas=None) -> Path:
    d, a, alpha = zip(*UR10E, strict=True)
    lines = ["[DH]", f"a = {list(a)}", f"d = {list(d)}", f"alpha = {list(map(float, alpha))} # rad", "q_home_offset = [0, -1.57, 0, -1.57, 0, 0]"]
    (folder / "urcontrol.conf").write_text("\n".join(lines) + "\n")
    lines = ["[mounting]", *(f"{key} = {row}" for key, row in (deltas or DELTAS).items()), "joint_checksum = [ 0x6e0f7bf, 0xa32a713f]"]
    path = folder / "calibration.conf"
    path.write_text("\n".join([*lines, "calibration_status = 2 # 0 == notInitialized / 1 == notLinearised / 2 == Linearised"]) + "\n")
    return path


def test_files_of_a_controller(tmp_path):
    path = controller_files(tmp_path)
    theta, a, d, alpha = DELTAS.values()
    rows = [
        (theta[k], d[k] + UR10E[k][0], a[k] + UR10E[k][1], alpha[k] + UR10E[k][2])
        for k in range(6)
    ]
    joints = np.random.default_rng(2).uniform(-3, 3, (CONFIGURATIONS, 6))
    robot = package.Robot.read(path)
    assert robot.joint_names == ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
    assert_same("calibration.conf", placed(robot), (joints, np.array([by_dh(rows, q) for q in joints])))
    nominal = package.Robot.read(tmp_path / "urcontrol.conf")
    rows = [(0.0, d, a, alpha) for d, a, alpha in UR10E]
    assert_same("urcontrol.conf", placed(nominal), (joints, np.array([by_dh(rows, q) for q in joints])))
    # To the driver's YAML and back.
    (tmp_path / "arm.yaml").write_text(poecal("export", path, "--format", "ur", "--hash", "calib_1"))
    again = package.Robot.read(tmp_path / "arm.yaml")
    assert_same("arm.yaml", placed(again), (joints, robot.forward_kinematics(joints)))
    assert again.joint_names == robot.joint_names
    # As truth: measurements of the calibrated arm, fitted from the nominal one, find it.
    poecal("simulate", path, "--errors", "0deg,0mm", "--noise", "0deg,0mm", "--count", 80, "--kind", "pose", "--out", tmp_path / "sim")
    poecal("calibrate", tmp_path / "urcontrol.conf", tmp_path / "sim/measurements.csv", "--tolerance", "none", "--out", tmp_path / "out")
    held_out = json.loads((tmp_path / "out/calibration.json").read_text())["accuracy"]["training"]["calibrated"]
    print("factory calibration found from measurements:", held_out)


def test_yaml_of_makers(tmp_path):
    origins = [(0.1 * k, -0.02 * k, 0.3, 0.1 * k, 0.2, -0.3 * k) for k in range(1, 9)]
    entry = lambda origin: dict(zip(["x", "y", "z", "roll", "pitch", "yaw"], origin, strict=True))  # noqa: E731
    joints = np.random.default_rng(3).uniform(-3, 3, (CONFIGURATIONS, 7))

    def place(q, count):
        found = np.eye(4)
        for origin, value in zip(origins, [*q[:count], 0.0], strict=False):
            found = found @ of_rpy(origin[:3], origin[3:]) @ about(2, value)
        return found

    lines = [f"joint{k}:\n  kinematic: {json.dumps(entry(origin))}\n" for k, origin in enumerate(origins, 1)]
    (tmp_path / "fr3.yaml").write_text("".join(lines))
    robot = package.Robot.read(tmp_path / "fr3.yaml")
    truth = np.array([place(q, 7) for q in joints])
    assert_same("Franka", placed(robot), (joints, truth))
    (tmp_path / "xarm6.yaml").write_text(json.dumps({"kinematics": {f"joint{k}": entry(origins[k - 1]) for k in range(1, 7)}}))
    robot = package.Robot.read(tmp_path / "xarm6.yaml")
    inverse = np.linalg.inv(of_rpy(origins[6][:3], origins[6][3:]))
    assert_same("xArm", placed(robot), (joints[:, :6], np.array([place([*q[:6], 0.0], 6) @ inverse for q in joints])))


MOC = """MOC:CFG_1.0:6:0::
#
ARM_CALIB:

      -name "rob1_1" -absacc_version 2 -error_offset_x 0.0003\\
      -error_roll 0.0004

      -name "rob1_2" -error_offset_x -0.0004 -error_pitch -0.0003
#
JOINT_CALIB:

      -name "rob1_1"

      -name "rob1_2" -Compl 1.14E-05
"""


def test_what_a_maker_found_is_a_tolerance(tmp_path):
    """Sizes of ABB's calibration: root mean squares of 0.35 mm and 0.020 deg here."""
    (tmp_path / "MOC.cfg").write_text(MOC)
    poecal("simulate", ELBOW, "--kind", "pose", "--count", 60, "--errors", "0.02deg,0.35mm", "--out", tmp_path / "sim", "--quiet")
    command = [program(), "calibrate", ELBOW, tmp_path / "sim/measurements.csv", "--tolerance", tmp_path / "MOC.cfg", "--out", tmp_path / "out"]
    run = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    said = " ".join(run.stderr.split())
    assert "tolerance 0.0203 deg, 0.3536 mm: the root mean squares of the 4 errors of axes" in said and "compliance of rob1_2" in said, run.stderr
    robot = package.Robot.read(ELBOW)
    measurements = package.Measurements.from_csv(tmp_path / "sim/measurements.csv", robot)
    by_file = package.calibrate(robot, measurements, tolerance_deg_mm=str(tmp_path / "MOC.cfg"))
    by_numbers = package.calibrate(robot, measurements, tolerance_deg_mm=(np.rad2deg(np.sqrt(12.5e-8)), 1e3 * np.sqrt(12.5e-8)))
    assert np.allclose(by_file.robot.screws, by_numbers.robot.screws, atol=1e-12)
    (tmp_path / "MOC.cfg").write_text(MOC.replace("0.0003\\", "0,0003\\"))
    run = subprocess.run(list(map(str, command)) + ["--force"], capture_output=True, text=True)
    assert run.returncode == 2 and "MOC.cfg:5: found `0,0003` for `-error_offset_x`" in " ".join(run.stderr.split()), run.stderr
