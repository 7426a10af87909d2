#!/usr/bin/env bash
# Joint values beyond the limits of a URDF, in forward kinematics of COMPAS and pytransform3d.
#
# Expected: the pose at the value that was given, as in pinocchio, MuJoCo, Drake, yourdfpy and others, or an
# error. A continuous joint has no limits, whatever its <limit> states.
# What happens: compas_robots puts the joint at the limit and answers with the pose there. pytransform3d
# does so too, as its documentation says, but also for a continuous joint, whose lower and upper the URDF
# specification tells readers to ignore: half of a wheel, a wrist or a turntable cannot be reached. Nothing
# is said.
# Whom it hurts: whoever computes residuals of a calibration: encoders read a little beyond a limit at a hard
# stop, limits in a URDF are often tighter than the arm's, and readings may be a turn away. Such rows look
# like errors of measurement.
# poecal: takes readings as they are and warns of each joint with rows beyond its limits; of a continuous
# joint it ignores the limits.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check compas_robots==1.0.1 compas==2.15.1 \
  pytransform3d==3.17.0 lxml==6.1.3 pin==4.1.0 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import math
import sys
from importlib.metadata import version
import numpy as np
import pinocchio
from compas_robots import RobotModel
from pytransform3d.urdf import UrdfTransformManager

print(", ".join(f"{name} {version(name)}" for name in ("compas_robots", "pytransform3d", "pin")))


def text(kind):
    return f"""<robot name="one"><link name="base"/><link name="arm"/><link name="tool"/>
 <joint name="j" type="{kind}"><parent link="base"/><child link="arm"/><origin xyz="0 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
 <joint name="mount" type="fixed"><parent link="arm"/><child link="tool"/><origin xyz="1 0 0"/></joint></robot>"""


def by_compas(kind, value):
    return RobotModel.from_urdf_string(text(kind)).forward_kinematics({"j": value}, link_name="tool").point


def by_pytransform3d(kind, value):
    manager = UrdfTransformManager()
    manager.load_urdf(text(kind))
    manager.set_joint("j", value)
    return manager.get_transform("tool", "base")[:3, 3]


def by_pinocchio(kind, value):
    model = pinocchio.buildModelFromXML(text(kind))
    data = model.createData()
    values = [math.cos(value), math.sin(value)] if model.nq == 2 else [value]
    pinocchio.framesForwardKinematics(model, data, np.array(values))
    return data.oMf[model.getFrameId("tool")].translation


unchanged = True
readers = {"compas_robots": by_compas, "pytransform3d": by_pytransform3d, "pinocchio": by_pinocchio}
clamping = {"revolute": ("compas_robots", "pytransform3d"), "continuous": ("pytransform3d",)}
print("angle of the tool, limits -1 to 1 rad:")
for kind, clamp in clamping.items():
    for value in (0.9, 1.01, 2.5):
        angles = {name: math.atan2(*np.asarray(read(kind, value))[1::-1]) for name, read in readers.items()}
        print(f"  {kind:10} at {value:4} rad:", ", ".join(f"{name} {angle:.3f}" for name, angle in angles.items()))
        for name, angle in angles.items():
            unchanged = unchanged and abs(angle - (min(value, 1.0) if name in clamp else value)) < 1e-9
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
