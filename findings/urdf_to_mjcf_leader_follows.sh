#!/usr/bin/env bash
# A URDF joint that follows another, converted to MJCF by urdf-to-mjcf.
#
# Expected: an <equality> by which the follower is multiplier times its leader plus offset, as MuJoCo's own URDF
# reader makes it; and the numbers of the URDF with their digits.
# What happens: the two joints are exchanged: the leader is held at multiplier times the follower plus offset. With
# 2 and 0.1 a leader at 0.5 should have its follower at 1.1, and has it at 0.2. With multipliers of 1 and -1 and
# no offset, as in grippers, both are the same, so that nothing shows. Besides, all numbers are rounded to four
# decimals, origins to 0.1 mm and quaternions too: the end of a robot of four joints is 0.03 mm and 0.09 mrad
# elsewhere. Nothing is said.
# Whom it hurts: whoever takes an arm with a linkage, a coupled wrist or a gear to MuJoCo; and whoever takes a
# calibrated URDF there, since its corrections are hardly larger than the rounding. MuJoCo 4 reads the URDF itself.
# poecal: takes multiplier and offset of a URDF as they are; numbers that it corrects have full precision.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check urdf-to-mjcf==0.1.1 mujoco==4.0.0 numpy==2.4.6 scipy==1.17.1 trimesh==5.2.0
cd "$here"
cat > run.py <<'PY'
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path
import mujoco
import numpy as np

print(", ".join(f"{name} {version(name)}" for name in ("urdf-to-mjcf", "mujoco")))
LINK = """<link name="{}"><inertial><mass value="1"/><origin xyz="0.01 0 0"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.05 0.05 0.1"/></geometry></collision></link>"""
JOINT = """<joint name="j{0}" type="{4}"><parent link="l{1}"/><child link="l{0}"/><origin xyz="{2}" rpy="{3}"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" effort="1" velocity="1"/>{5}</joint>"""
PLACES = (
    ("0.10003 0.02004 0.30003", "0.1 -0.2 0.3"),
    ("0.05004 0.20003 0.40004", "-0.4 0.3 1.2"),
    ("0.30003 0.00004 0.10004", "1.5707963 0.1 0"),
    ("0.10004 0.10003 0.10004", "0 1.2 0.1"),
)
VALUES = (0.3, -0.7, 0.15, 0.9)


def urdf(multiplier=None, offset=None):
    follows = "" if multiplier is None else f'<mimic joint="j1" multiplier="{multiplier}" offset="{offset}"/>'
    joints = (JOINT.format(i + 1, i, *place, "prismatic" if i == 2 else "revolute", follows if i == 1 else "") for i, place in enumerate(PLACES))
    return f'<robot name="arm">{"".join(LINK.format(f"l{i}") for i in range(5))}{"".join(joints)}</robot>'


def converted(text):
    Path("arm.urdf").write_text(text)
    done = subprocess.run([Path(sys.executable).parent / "urdf-to-mjcf", "arm.urdf", "-o", "out/robot.xml"], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr[-2000:])
    return mujoco.MjModel.from_xml_path("out/robot.xml")


def follower(model, leader):
    """Where the second joint satisfies the constraint, with the first at a value: it is linear."""
    data, misses = mujoco.MjData(model), []
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    for value in (0.0, 1.0):
        data.qpos[model.joint("j1").qposadr[0]], data.qpos[model.joint("j2").qposadr[0]] = leader, value
        mujoco.mj_forward(model, data)
        misses += data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY].tolist()
    return misses[0] / (misses[0] - misses[1])


def tool(model):
    """The last link in the frame of the first."""
    data = mujoco.MjData(model)
    for number, value in enumerate(VALUES, 1):
        data.qpos[model.joint(f"j{number}").qposadr[0]] = value
    mujoco.mj_kinematics(model, data)
    names = [model.body(i).name for i in range(model.nbody)]
    base, last = data.body("l0" if "l0" in names else "world"), data.body("l4")
    turned = base.xmat.reshape(3, 3).T
    return turned @ (last.xpos - base.xpos), turned @ last.xmat.reshape(3, 3)


unchanged = True
for multiplier, offset in ((1, 0), (-1, 0), (2, 0), (2, 0.1)):
    text = urdf(multiplier, offset)
    found, own = follower(converted(text), 0.5), follower(mujoco.MjModel.from_xml_string(text), 0.5)
    wanted, exchanged = multiplier * 0.5 + offset, (0.5 - offset) / multiplier
    print(f"  multiplier {multiplier:2}, offset {offset:3}: leader at 0.5, follower {wanted:5.2f} by URDF, {own:6.3f} by MuJoCo's own reader, {found:6.3f} converted")
    unchanged = unchanged and abs(found - exchanged) < 1e-9 and abs(own - wanted) < 1e-9
place, turn = tool(mujoco.MjModel.from_xml_string(urdf()))
given = tool(converted(urdf()))
apart = 1000 * np.linalg.norm(given[0] - place), 1000 * np.linalg.norm(given[1] @ turn.T - np.eye(3)) / np.sqrt(2)
print(f"  tool after conversion: {apart[0]:.3f} mm and {apart[1]:.3f} mrad elsewhere")
unchanged = unchanged and 0.02 < apart[0] < 1
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
"$here/venv/bin/python" run.py
