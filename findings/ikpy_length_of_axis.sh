#!/usr/bin/env bash
# A URDF axis that is not exactly of length one, in ikpy.
#
# Expected: the length of <axis> does not matter, as in urdfdom, pinocchio, MuJoCo and others.
# What happens: the axis is used as it is written. A turning joint then has a matrix that is no
# rotation: distances grow or shrink, and its determinant is not one. A sliding joint moves by the
# length of its axis times its value. Nothing is said.
# Whom it hurts: whoever writes an axis with three digits. "0.707 0.707 0" is too short by 0.00015,
# which moves a tool at a distance of 1 m by up to 0.3 mm: more than a calibrated arm is off.
# poecal: takes the direction alone; axes that it writes have full precision.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check ikpy==4.2.1 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from scipy.spatial.transform import Rotation
from ikpy.chain import Chain

print("ikpy", version("ikpy"))
URDF = """<robot name="one"><link name="base"/><link name="arm"/><link name="tool"/>
<joint name="j" type="{kind}"><parent link="base"/><child link="arm"/><axis xyz="{axis}"/>
 <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="1 0 0" rpy="0 0 0"/></joint></robot>"""


def pose(kind, axis, value):
    with open("one.urdf", "w") as file:
        file.write(URDF.format(kind=kind, axis=axis))
    chain = Chain.from_urdf_file("one.urdf", base_elements=["base"])
    return chain.forward_kinematics([value if link.name == "j" else 0.0 for link in chain.links])


unchanged = True
print("a turn by 2 rad, tool 1 m from the axis:")
for axis, least in (("0 0 1", 0), ("0.707 0.707 0", 1e-4), ("0.577 0.577 0.577", 1e-4), ("0 0 2", 0.1)):
    direction = np.array([float(word) for word in axis.split()])
    right = Rotation.from_rotvec(2 * direction / np.linalg.norm(direction)).apply([1, 0, 0])
    got = pose("revolute", axis, 2.0)
    determinant, miss = np.linalg.det(got[:3, :3]), np.linalg.norm(got[:3, 3] - right)
    print(f"  axis {axis:18} determinant {determinant:.6f}   tool off by {1000 * miss:.3f} mm")
    unchanged = unchanged and (miss < 1e-12 if least == 0 else miss > least and abs(determinant - 1) > least)
slid = pose("prismatic", "0 0 2", 0.1)[2, 3]
print(f"a slide by 100 mm along 0 0 2: {1000 * slid:.1f} mm")
unchanged = unchanged and abs(slid - 0.2) < 1e-12
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
