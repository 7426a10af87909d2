#!/usr/bin/env bash
# A URDF axis with a small tilt, in Klampt.
#
# Expected: the direction of <axis> counts and its length does not, as in urdfdom, pinocchio and MuJoCo.
# What happens: a frame is turned from z onto the axis by an angle whose cosine is the z of the axis as it
# is written. Where that is 1 or more, as in "0 0.01 1", the tilt is lost and the joint turns about z;
# "1 2 3" turns about x. Other lengths than one give a wrong tilt, and a value is multiplied by the
# length: "0 0 2" turns and slides twice as far. Matrices stay rotations, and nothing is said.
# Whom it hurts: whoever writes the tilt of a joint by hand, small and beside a 1, or with three digits:
# 10 mrad that the calibration found are 3 mm at 1 m for a turn of 0.3 rad.
# poecal: takes the direction alone; axes that it writes have length one in full precision, which
# Klampt reads right.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check Klampt==0.10.1.post1 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - 3>&1 > parser.log <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from klampt import WorldModel
from scipy.spatial.transform import Rotation

out = open(3, "w", buffering=1)  # Klampt's parser prints to the other one
print("Klampt", version("Klampt"), file=out)
LIMIT = '<limit lower="-3" upper="3" effort="1" velocity="1"/>'


def tool(kind, axis, value):
    """A tool at 1 m, and the determinant of its rotation."""
    with open("one.urdf", "w") as file:
        file.write(f"""<robot name="one"><link name="base"/><link name="arm"/><link name="tool"/>
<joint name="j" type="{kind}"><parent link="base"/><child link="arm"/><origin xyz="0 0 0"/><axis xyz="{axis}"/>{LIMIT}</joint>
<joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="1 0 0"/></joint></robot>""")
    world = WorldModel()
    world.loadRobot("one.urdf")
    robot = world.robot(0)
    links = [robot.link(index).getName() for index in range(robot.numLinks())]
    config = robot.getConfig()
    config[links.index("arm")] = value
    robot.setConfig(config)
    turn, place = robot.link(links.index("tool")).getTransform()
    return np.array(place), np.linalg.det(np.reshape(turn, (3, 3)))


unchanged = True
print("a turn by 0.3 rad:", file=out)
for axis, least in (
    ("0 0 1", 0), ("0.8 0 0.6", 0), ("0.0099995000374968752 0 0.99995000374968752", 0),
    ("0.01 0 1", 1e-4), ("0 0.01 1", 1e-3), ("0.577 0.577 0.577", 1e-4), ("1 2 3", 0.1), ("0 0 2", 0.1),
):
    direction = np.array(axis.split(), float)
    right = Rotation.from_rotvec(0.3 * direction / np.linalg.norm(direction)).apply([1, 0, 0])
    place, determinant = tool("revolute", axis, 0.3)
    miss = np.linalg.norm(place - right)
    print(f"  axis {axis:44} tool off by {1000 * miss:8.3f} mm", file=out)
    unchanged = unchanged and abs(determinant - 1) < 1e-9 and (miss < 1e-9 if least == 0 else miss > least)
place, _ = tool("prismatic", "0 0 2", 0.1)
print(f"a slide by 100 mm along 0 0 2: {1000 * place[2]:.1f} mm", file=out)
unchanged = unchanged and abs(place[2] - 0.2) < 1e-9
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes", file=out)
sys.exit(not unchanged)
PY
