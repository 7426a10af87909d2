#!/usr/bin/env bash
# A URDF joint with <mimic>, in ManipulaPy.
#
# Expected: one package understands a URDF once: link_fk of the model and the manipulator that is made of it have the
# tip at the same place.
# What happens: link_fk follows the leader. to_serial_manipulator leaves the follower out of its screws, so that it
# stays where it is while its leader is at zero: forward kinematics, Jacobians and inverse kinematics of the
# manipulator, which is what the package is for, are of another arm. At zero both agree. Nothing is said.
# Whom it hurts: whoever has a parallelogram, a telescope or a palletiser with a follower: the tip is off by
# decimetres.
# poecal: followers count in predictions, calibrations and exports.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check ManipulaPy==1.4.2 numpy==2.4.6 scipy==1.17.1
cd "$here"
MANIPULAPY_QUIET=1 "$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from ManipulaPy.urdf import URDF

print("ManipulaPy", version("ManipulaPy"))
LIMIT = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'
INERTIA = '<inertial><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial>'


def robot(mimic):
    joints = "".join(
        f'<joint name="j{k}" type="revolute"><parent link="l{k - 1}"/><child link="l{k}"/><origin xyz="{0.0 if k == 1 else 0.5} 0 0"/>'
        f'<axis xyz="0 0 1"/>{LIMIT}{mimic if k == 2 else ""}</joint>' for k in (1, 2, 3))
    mount = '<joint name="mount" type="fixed"><parent link="l3"/><child link="tip"/><origin xyz="0.2 0 0"/></joint>'
    return f'<robot name="r">{"".join(f"<link name={chr(34)}{name}{chr(34)}>{INERTIA}</link>" for name in ("l0", "l1", "l2", "l3", "tip"))}{joints}{mount}</robot>'


def right(first, second, third):
    angles = np.cumsum([first, second, third])
    return np.array([0.5, 0.5, 0.2]) @ np.stack([np.cos(angles), np.sin(angles)], axis=1)


unchanged = True
print("tip off by, mm: link_fk, the serial manipulator")
for words, multiplier, offset in (("", 0.0, 0.3), ('<mimic joint="j1" multiplier="-0.8" offset="0"/>', -0.8, 0.0), ('<mimic joint="j1" multiplier="-0.8" offset="0.1"/>', -0.8, 0.1)):
    with open("robot.urdf", "w") as file:
        file.write(robot(words))
    model = URDF.load("robot.urdf")
    for first, third in ((0.0, 0.0), (0.5, 0.2)):
        values = {"j1": first, "j2": multiplier * first + offset, "j3": third}
        if words:
            del values["j2"]
        truth = right(first, multiplier * first + offset, third)
        by_links = np.array(model.link_fk(values, use_names=True)["tip"])[:2, 3]
        by_screws = np.array(model.to_serial_manipulator().forward_kinematics(np.array(list(values.values()))))[:2, 3]
        off = [1000 * np.linalg.norm(place - truth) for place in (by_links, by_screws)]
        print(f"  {words or 'no follower':52} first joint at {first}: {off[0]:8.3f} {off[1]:8.3f}")
        unchanged = unchanged and off[0] < 1e-9
        unchanged = unchanged and (off[1] > 60 if words and first else off[1] < 1e-9)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
