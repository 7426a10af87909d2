#!/usr/bin/env bash
# An MJCF body with two joints, in Drake beside MuJoCo.
#
# Expected: the same poses from both. Drake reads joints, defaults, angles and `ref` as MuJoCo does.
# What happens: for bodies with one joint it does. Where a body has several, Drake puts its position and
# orientation before the last joint, in place of before the first one: the others turn about the origin
# and the axes of the parent. At zero both agree; with joints at 0.3 and 0.5 rad a tool at 1 m is 168 mm
# elsewhere. Nothing is said.
# Whom it hurts: whoever takes a robot from MuJoCo to Drake: two joints in a body are how MJCF says
# universal joints, wrists, gimbals, and slides with a turntable. A body for each joint helps.
# poecal: places the joints as MuJoCo does.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check drake==1.51.1 mujoco==4.0.0 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import mujoco
import numpy as np
from pydrake.all import MultibodyPlant, Parser
from scipy.spatial.transform import Rotation

print("Drake", version("drake"), "and MuJoCo", mujoco.__version__)
MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def model(joints, place='pos="0 0 0.5" euler="0.3 0.2 0.4"'):
    return f"""<mujoco model="arm"><compiler angle="radian"/><worldbody><body name="base">{MASS}
    <body name="arm" {place}>{MASS}{joints}<body name="tool" pos="1 0 0">{MASS}</body></body></body></worldbody></mujoco>"""


def pose(turn=(0, 0, 0), place=(0, 0, 0)):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = Rotation.from_rotvec(turn).as_matrix(), place
    return matrix


def by_mujoco(text, values):
    one = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(one)
    for name, value in values.items():
        data.joint(name).qpos[:] = value
    mujoco.mj_kinematics(one, data)
    return data.body("tool").xpos.copy()


def by_drake(text, values):
    with open("arm.xml", "w") as file:
        file.write(text)
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels("arm.xml")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    positions = plant.GetPositions(context).copy()
    for name, value in values.items():
        positions[plant.GetJointByName(name).position_start()] = value
    plant.SetPositions(context, positions)
    return plant.CalcRelativeTransform(context, plant.world_frame(), plant.GetFrameByName("tool")).translation()


first, second = '<joint name="first" axis="1 0 0"/>', '<joint name="second" axis="0 1 0"/>'
slide = '<joint name="first" type="slide" axis="1 0 0"/>'
both = {"first": 0.3, "second": 0.5}
cases = {
    "one hinge": (model(first), {"first": 0.3}, False),
    "two hinges, both at zero": (model(first + second), {"first": 0.0, "second": 0.0}, False),
    "two hinges": (model(first + second), both, True),
    "two hinges, body not turned": (model(first + second, 'pos="0 0 0.5"'), both, True),
    "slide and hinge": (model(slide + second), both, True),
}
unchanged = True
print("tool at 1 m, Drake and MuJoCo apart:")
for name, (text, values, differ) in cases.items():
    apart = 1000 * np.linalg.norm(by_drake(text, values) - by_mujoco(text, values))
    print(f"  {name:34} {apart:10.3f} mm")
    unchanged = unchanged and (apart > 50 if differ else apart < 1e-9)
body = pose(place=(0, 0, 0.5))
body[:3, :3] = Rotation.from_euler("XYZ", (0.3, 0.2, 0.4)).as_matrix()
turns, tool = (pose(turn=(0.3, 0, 0)), pose(turn=(0, 0.5, 0))), pose(place=(1, 0, 0))
two, _, _ = cases["two hinges"]
unchanged = unchanged and np.allclose(by_mujoco(two, both), (body @ turns[0] @ turns[1] @ tool)[:3, 3], atol=1e-12)
unchanged = unchanged and np.allclose(by_drake(two, both), (turns[0] @ body @ turns[1] @ tool)[:3, 3], atol=1e-12)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
