#!/usr/bin/env bash
# A URDF that is loaded, rewritten and loaded again, in PyBullet.
#
# Expected: loadURDF reads the file, at the latest after resetSimulation.
# What happens: a URDF that was read once is kept by its name for as long as the connection lasts. Rewritten
# and loaded again, after resetSimulation too, the robot is the old one. Nothing is said. Another name,
# a new connection, or setPhysicsEngineParameter(enableFileCaching=0) before the first load helps.
# Whom it hurts: whoever calibrates or tunes in a loop, writes the URDF, loads it and compares: no step has
# an effect, and a calibrated robot beside its nominal one, loaded by one name, is the same robot.
# poecal: reads its files at every run, and writes the calibrated robot beside the given one, under another
# name.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pybullet==3.2.7 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import pybullet

print("PyBullet", version("pybullet"))
MASS = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def write(name, length):
    with open(name, "w") as file:
        file.write(f"""<robot name="one"><link name="base">{MASS}</link><link name="tool">{MASS}</link><joint name="j" type="revolute">
 <parent link="base"/><child link="tool"/><origin xyz="{length} 0 0"/><axis xyz="0 0 1"/>
 <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>""")


def loaded(name):
    body = pybullet.loadURDF(name, useFixedBase=True)
    return round(pybullet.getLinkState(body, 0, computeForwardKinematics=True)[4][0], 6)


seen = {}
pybullet.connect(pybullet.DIRECT)
write("arm.urdf", 1)
seen["written with 1 m"] = loaded("arm.urdf")
write("arm.urdf", 2)
seen["written again with 2 m"] = loaded("arm.urdf")
pybullet.resetSimulation()
seen["after resetSimulation"] = loaded("arm.urdf")
write("other.urdf", 2)
seen["the same under another name"] = loaded("other.urdf")
pybullet.disconnect()
pybullet.connect(pybullet.DIRECT)
seen["after a new connection"] = loaded("arm.urdf")
pybullet.setPhysicsEngineParameter(enableFileCaching=0)
write("arm.urdf", 3)
seen["without file caching, 3 m"] = loaded("arm.urdf")
for name, length in seen.items():
    print(f"  {name:28} the tool is at {length} m")
unchanged = list(seen.values()) == [1, 1, 1, 2, 2, 3]
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
