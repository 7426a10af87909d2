#!/usr/bin/env bash
# An MJCF robot with `ref` and with a joint without range, made a URDF by mjcf_urdf_simple_converter.
#
# Expected: the URDF has the poses of the MJCF at the same joint values, since hinges and their limits are
# what the converter says that it converts; a hinge without a range becomes a continuous joint.
# What happens: `ref`, the value of a joint in the pose of the file, is dropped: the tool is turned by it at
# every value, and the limits, which count with it, lie elsewhere. A hinge without a range becomes a
# revolute joint with limits of 0 and 0. Nothing is said.
# Whom it hurts: whoever takes a robot of MuJoCo to ROS or to a calibration: an offset of a joint that no
# encoder has; and readers that hold joints to their limits keep the joint at zero.
# poecal: reads MJCF itself, with `ref`, as MuJoCo does. Of a URDF from here it cannot know; limits of 0 and
# 0 it takes for none, and `poecal check` shows that.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check mjcf-urdf-simple-converter==0.7.3 mujoco==4.0.0 \
  pin==4.1.0 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
import xml.etree.ElementTree as ElementTree
from importlib.metadata import version
import mujoco
import numpy as np
import pinocchio
from mjcf_urdf_simple_converter import convert

print("mjcf_urdf_simple_converter", version("mjcf-urdf-simple-converter"), "and MuJoCo", mujoco.__version__)
MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def apart(joint, value):
    """The tool by the URDF and by the MJCF in mm, and the limits in the URDF."""
    text = f"""<mujoco><compiler angle="radian"/><worldbody><body name="base">{MASS}<body name="arm" pos="0 0 0.5">{MASS}
     <joint name="j" {joint}/><body name="tool" pos="1 0 0">{MASS}</body></body></body></worldbody></mujoco>"""
    with open("arm.xml", "w") as file:
        file.write(text)
    convert("arm.xml", "arm.urdf")
    one = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(one)
    data.qpos[:] = value
    mujoco.mj_kinematics(one, data)
    other = pinocchio.buildModelFromUrdf("arm.urdf")
    other_data = other.createData()
    pinocchio.framesForwardKinematics(other, other_data, np.array([value]))
    tool = other_data.oMf[other.getFrameId("tool")].translation
    limit = ElementTree.parse("arm.urdf").find("joint[@name='j']/limit")
    limits = tuple(float(limit.get(end)) for end in ("lower", "upper"))
    return 1000 * np.linalg.norm(tool - data.body("tool").xpos), limits


unchanged = True
print("a joint at 0.3 rad, tool at 1 m:")
for joint, differ, expected in (
    ('axis="0 1 0" range="-2 2"', False, (-2, 2)),
    ('axis="0 1 0" range="-2 2" pos="0.1 0 0"', False, (-2, 2)),
    ('axis="0 1 0" range="-1 3" ref="1"', True, (-1, 3)),
    ('axis="0 1 0"', False, (0, 0)),
):
    miss, limits = apart(joint, 0.3)
    print(f"  {joint:42} URDF off by {miss:7.3f} mm, limits {limits[0]} to {limits[1]}")
    unchanged = unchanged and (miss > 100 if differ else miss < 1e-6) and limits == expected
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
