#!/usr/bin/env bash
# Rotations of MJCF bodies: MuJoCo beside pinocchio's reader of the same file.
#
# Expected: buildModelFromMJCF puts bodies where MuJoCo does, since it reads eulerseq, axisangle and
# classes of defaults.
# What happens: for simple files it does. But capitals in eulerseq, which mean turns about fixed axes,
# are taken for turns about moving ones; the axis of axisangle is not brought to length one, so that the
# body has a matrix that is no rotation; and of a default class within another the position of the joint
# is lost, while its axis is inherited. Nothing is said.
# Whom it hurts: whoever checks or calibrates with pinocchio a robot that is simulated with MuJoCo.
# What helps: a file that MuJoCo saved states quaternions, of six digits; classes remain.
# poecal: agrees with MuJoCo in each of these.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pin==4.1.0 mujoco==4.0.0 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" - <<'PY'
import sys
import mujoco
import numpy as np
import pinocchio

print("pinocchio", pinocchio.__version__, "and MuJoCo", mujoco.__version__)
MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def model(body="", joint='axis="0 0 1"', eulerseq="xyz", defaults=""):
    return f"""<mujoco><compiler angle="radian" eulerseq="{eulerseq}"/><default>{defaults}</default><worldbody>
    <body name="arm" {body}>{MASS}<joint name="turn" {joint}/><body name="tool" pos="1 0.2 0.1">{MASS}</body></body></worldbody></mujoco>"""


def poses(text, value=0.3):
    one = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(one)
    data.qpos[:] = value
    mujoco.mj_kinematics(one, data)
    tool = data.body("tool")
    with open("model.xml", "w") as file:
        file.write(text)
    other = pinocchio.buildModelFromMJCF("model.xml")
    other_data = other.createData()
    pinocchio.framesForwardKinematics(other, other_data, np.full(other.nq, value))
    frame = other_data.oMf[other.getFrameId("tool")]
    return tool.xpos.copy(), tool.xmat.reshape(3, 3).copy(), frame.translation.copy(), frame.rotation.copy()


NESTED = '<default class="outer"><joint axis="0 1 0"/><default class="inner"><joint pos="0.1 0 0"/></default></default>'
cases = {
    "euler, moving axes": (model('euler="0.1 0.2 0.3"'), False),
    "euler, fixed axes": (model('euler="0.1 0.2 0.3"', eulerseq="XYZ"), True),
    "axisangle, length 1": (model('axisangle="0 0.6 0.8 0.4"'), False),
    "axisangle, length 3.7": (model('axisangle="1 2 3 0.4"'), True),
    "position of the joint": (model(joint='axis="0 1 0" pos="0.1 0 0"'), False),
    "position by a class": (model(joint='class="inner"', defaults=NESTED), True),
}
unchanged = True
print("tool of a joint at 0.3 rad:  MuJoCo and pinocchio apart   determinant of pinocchio's matrix")
for name, (text, differ) in cases.items():
    position, turn, other_position, other_turn = poses(text)
    apart, determinant = 1000 * np.linalg.norm(position - other_position), np.linalg.det(other_turn)
    print(f"  {name:24} {apart:12.3f} mm   {determinant:25.6f}")
    unchanged = unchanged and (apart > 10 if differ else apart < 1e-9)
    unchanged = unchanged and (abs(determinant - 1) > 1 if name == "axisangle, length 3.7" else abs(determinant - 1) < 1e-12)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
