#!/usr/bin/env bash
# A URDF joint whose axis is not exactly along x, y or z, in roboticstoolbox-python.
#
# Expected: any <axis> works. Its direction matters, its components do not.
# What happens: if the axis is off a coordinate axis by as little as 1e-9, z is not turned onto it.
# Instead the link is turned by one radian about it, and the joint then turns about the z that this
# gives. At a joint value of zero the tool already stands up to 57 degrees off. Nothing is said.
# Whom it hurts: whoever loads a robot whose axes were measured, rounded or exported from CAD, since
# these are never exactly along a coordinate axis. Nominal models are not affected.
# What helps: the same tilt in the joint's <origin>, with an axis along x, y or z.
# poecal: reads such an axis as any other. Corrections of a calibration go into <origin>: the axes of a
# calibrated URDF are those of the nominal one, so that it loads as it should where they are along x, y, z.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check roboticstoolbox-python==1.5.0 spatialmath-python==1.1.18 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import os
import sys
from importlib.metadata import version
import numpy as np
from scipy.spatial.transform import Rotation
import roboticstoolbox as rtb

print("roboticstoolbox-python", version("roboticstoolbox-python"))
URDF = """<robot name="one"><link name="base"/><link name="arm"/><link name="tool"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0" rpy="{rpy}"/>
 <axis xyz="{axis}"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="1 0 0" rpy="0 0 0"/></joint></robot>"""


def tool(axis, value, rpy="0 0 0"):
    with open("one.urdf", "w") as file:
        file.write(URDF.format(axis=axis, rpy=rpy))
    return rtb.Robot.URDF(os.path.abspath("one.urdf")).fkine([value], end="tool").t


def right(axis, value):
    axis = np.array([float(word) for word in axis.split()])
    return Rotation.from_rotvec(value * axis / np.linalg.norm(axis)).apply([1, 0, 0])


def miss(axis, value):
    return 1000 * np.linalg.norm(tool(axis, value) - right(axis, value))


print("tool 1 m from the axis: how far it is from where it should be, in mm")
rows = {axis: [miss(axis, value) for value in (0.0, 0.5)] for axis in ("0 0 1", "0 -1 0", "0 1e-9 1", "0 0.001 1", "0.6 0 0.8")}
for axis, (zero, half) in rows.items():
    print(f"  axis {axis:10}  at 0 rad {zero:8.1f}   at 0.5 rad {half:8.1f}")
# The same tilt of 1 mrad as an origin: a turn about x.
instead = 1000 * np.linalg.norm(tool("0 0 1", 0.5, "-0.001 0 0") - Rotation.from_euler("x", -0.001).apply(right("0 0 1", 0.5)))
print(f"  tilt of 0.001 in the origin, axis 0 0 1: {instead:.1f} at 0.5 rad")
# One radian of a tool 1 m from the axis is a chord of 2 sin(0.5) = 0.959 m.
unchanged = max(rows["0 0 1"] + rows["0 -1 0"]) < 1e-9 and instead < 1e-9
unchanged = unchanged and all(abs(miss - 958.9) < 1 for axis in ("0 1e-9 1", "0 0.001 1") for miss in rows[axis])
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
