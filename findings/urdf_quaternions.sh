#!/usr/bin/env bash
# A URDF whose joint states its orientation as a quaternion, in five readers.
#
# Expected: `quat_xyzw` of <origin>, of URDF 1.2, is read, or named as not understood.
# What happens: pinocchio, by urdfdom 6, reads it where <robot> says version="1.2", and leaves the joint
# unturned where the version is not stated. MuJoCo, yourdfpy, urchin and ikpy leave it unturned in both
# files. No reader says anything, though all but one have another robot than the file's author.
# Whom it hurts: whoever writes such a file, since rpy near the gimbal lock is awkward, and tests it with
# one reader: turns of whole joints are lost in the next one.
# poecal: refuses both files, with the line, the joint and what it expects: roll, pitch and yaw.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pin==4.1.0 cmeel-urdfdom==6.0.0 mujoco==4.0.0 \
  yourdfpy==0.0.60 urchin==0.0.30 ikpy==4.2.1 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import mujoco
import numpy as np
import pinocchio
import urchin
import yourdfpy
from ikpy.chain import Chain

print(", ".join(f"{name} {version(name)}" for name in ("pin", "cmeel-urdfdom", "mujoco", "yourdfpy", "urchin", "ikpy")))
HALF = 0.7071067811865476
MASS = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'


def text(stated, origin):
    return f"""<robot name="one"{stated}><link name="base"/><link name="arm">{MASS}</link>
 <joint name="j" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.5" {origin}/><axis xyz="1 0 0"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""


def by_pinocchio(robot):
    model = pinocchio.buildModelFromXML(robot)
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, np.zeros(1))
    return data.oMf[model.getFrameId("arm")].rotation


def by_mujoco(robot):
    model = mujoco.MjModel.from_xml_string(robot)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return data.body("arm").xmat.reshape(3, 3)


READERS = {
    "pinocchio": by_pinocchio,
    "MuJoCo": by_mujoco,
    "yourdfpy": lambda robot: yourdfpy.URDF.load("one.urdf").get_transform("arm", "base"),
    "urchin": lambda robot: urchin.URDF.load("one.urdf").link_fk(use_names=True)["arm"],
    "ikpy": lambda robot: Chain.from_urdf_file("one.urdf", base_elements=["base"]).forward_kinematics([0, 0]),
}
FILES = {
    'rpy="0 0 1.5707963267948966"': text("", 'rpy="0 0 1.5707963267948966"'),
    'quat_xyzw, version="1.2"': text(' version="1.2"', f'quat_xyzw="0 0 {HALF} {HALF}"'),
    "quat_xyzw, no version": text("", f'quat_xyzw="0 0 {HALF} {HALF}"'),
}
unchanged = True
print("turn about z of a joint that stands at 90 degrees:")
for name, robot in FILES.items():
    with open("one.urdf", "w") as file:
        file.write(robot)
    angles = {}
    for reader, read in READERS.items():
        turn = np.asarray(read(robot), float)
        angles[reader] = float(np.degrees(np.arctan2(turn[1, 0], turn[0, 0])))
    print(f"  {name:29}", "  ".join(f"{reader} {angle:.0f}" for reader, angle in angles.items()))
    for reader, angle in angles.items():
        read = name.startswith("rpy") or (reader == "pinocchio" and "1.2" in name)
        unchanged = unchanged and abs(angle - (90 if read else 0)) < 1e-6
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
