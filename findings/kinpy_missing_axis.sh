#!/usr/bin/env bash
# A URDF joint without <axis>, in kinpy.
#
# Expected: the axis is x, the default that the URDF specification states, as in urdfdom, pinocchio, MuJoCo,
# yourdfpy, ikpy and urchin.
# What happens: kinpy turns and slides along z. Joints that state "1 0 0" are right, so that a file with both
# is right in parts. A stated axis counts with its length for a slide: "0 0 2" moves twice as far, while
# turns by it are right. Nothing is said.
# Whom it hurts: whoever has a file that leaves defaults out, as programs that write short files do: a joint
# points elsewhere by 90 degrees, and a tool at 1 m by hundreds of millimetres.
# poecal: takes x for a missing axis, and the direction alone of a stated one.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check kinpy==0.6.1 pin==4.1.0 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import kinpy
import numpy as np
import pinocchio

print("kinpy", version("kinpy"), "beside pinocchio", pinocchio.__version__)


def text(kind, axis):
    return f"""<robot name="one"><link name="base"/><link name="arm"/><link name="tool"/>
 <joint name="j" type="{kind}"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.5"/>{axis}
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
 <joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="0.6 0.8 0"/></joint></robot>"""


def by_kinpy(robot, value):
    return np.asarray(kinpy.build_chain_from_urdf(robot.encode()).forward_kinematics({"j": value})["tool"].pos)


def by_pinocchio(robot, value):
    model = pinocchio.buildModelFromXML(robot)
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, np.array([value]))
    return data.oMf[model.getFrameId("tool")].translation


unchanged = True
print("tool of a joint at 0.3, kinpy and pinocchio apart:")
for kind in ("revolute", "prismatic"):
    for axis, differ in (('<axis xyz="1 0 0"/>', False), ("", True), ('<axis xyz="0 0 1"/>', False), ('<axis xyz="0 0 2"/>', kind == "prismatic")):
        apart = 1000 * np.linalg.norm(by_kinpy(text(kind, axis), 0.3) - by_pinocchio(text(kind, axis), 0.3))
        print(f"  {kind:10} {axis or 'no axis':20} {apart:9.3f} mm")
        unchanged = unchanged and (apart > 100 if differ else apart < 1e-9)
as_z = by_kinpy(text("revolute", ""), 0.3) - by_pinocchio(text("revolute", '<axis xyz="0 0 1"/>'), 0.3)
unchanged = unchanged and np.abs(as_z).max() < 1e-12
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
