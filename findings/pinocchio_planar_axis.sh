#!/usr/bin/env bash
# A URDF with a planar joint whose axis is not z, in Pinocchio beside MuJoCo, Drake and DART.
#
# Expected: <axis> of a planar joint is the normal of its plane, along x where it is left out: with `0 1 0` the
# child moves along x and z and turns about y, as it does in MuJoCo and Drake.
# What happens: Pinocchio reads the axis of hinges and slides, but not that of a planar joint: the child moves along x
# and y and turns about z, whatever the file says. DART does so where the axis is left out. Only `0 0 1` is read alike
# by all four. Nothing is said. Where they agree on the plane, they may differ in its axes: for `1 0 0` the
# first coordinate is along -z in MuJoCo and Drake, y in DART.
# Whom it hurts: whoever models a gantry, a cart on a wall, or the base of a mobile robot without <axis>: the
# plane lies, or stands, in one program and not in the other.
# poecal: refuses planar joints on the chain (docs/file-formats.md); two slides and a hinge say the same in all.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pin==4.1.0 mujoco==4.0.0 drake==1.51.1 dartpy==6.20.0 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import os
import sys
from importlib.metadata import version
import dartpy
import mujoco
import numpy as np
import pinocchio
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

print(", ".join(f"{name} {version(name)}" for name in ("pin", "mujoco", "drake", "dartpy")))
MASS = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
VALUES = [0.1, 0.2, 0.3]   # two shifts and a turn


def by_pinocchio(text):
    model = pinocchio.buildModelFromXML(text)
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, np.array([*VALUES[:2], np.cos(VALUES[2]), np.sin(VALUES[2])]))
    return data.oMf[model.getFrameId("cart")].homogeneous


def by_mujoco(text):
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[:] = VALUES
    mujoco.mj_kinematics(model, data)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = data.body("cart").xmat.reshape(3, 3), data.body("cart").xpos
    return pose


def by_drake(text):
    plant = MultibodyPlant(1e-3)
    Parser(plant).AddModelsFromString(text, "urdf")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    plant.GetJointByName("slab").set_pose(context, VALUES[:2], VALUES[2])
    base, cart = (plant.GetFrameByName(name).CalcPoseInWorld(context) for name in ("base", "cart"))
    return (base.inverse() @ cart).GetAsMatrix4()


def by_dart(text):
    with open("slab.urdf", "w") as file:
        file.write(text)
    robot = dartpy.utils.DartLoader().parseSkeleton(os.path.abspath("slab.urdf"))
    robot.getJoint("slab").setPositions(VALUES)
    base, cart = (robot.getBodyNode(name).getWorldTransform().matrix() for name in ("base", "cart"))
    return np.linalg.inv(base) @ cart


READERS = {"Pinocchio": by_pinocchio, "MuJoCo": by_mujoco, "Drake": by_drake, "DART": by_dart}
unchanged = True
print("normal of the plane: the axis of the turn, and how far the child is out of the plane, mm")
for stated, normal in (("0 0 1", [0, 0, 1]), ("1 0 0", [1, 0, 0]), ("0 1 0", [0, 1, 0]), ("", [1, 0, 0])):
    axis = f'<axis xyz="{stated}"/>' if stated else ""
    text = f"""<robot name="cart"><link name="base">{MASS}</link><link name="cart">{MASS}</link>
 <joint name="slab" type="planar"><parent link="base"/><child link="cart"/>{axis}</joint></robot>"""
    said = []
    for name, reader in READERS.items():
        pose = reader(text)
        turn = pinocchio.log3(pose[:3, :3]) / VALUES[2]
        out = 1000 * abs(pose[:3, 3] @ normal)
        said.append(f"{name} {' '.join(f'{abs(round(it)):d}' for it in turn)} {out:5.1f}")
        right = np.allclose(turn, normal, atol=1e-9) and out < 1e-9
        lies = np.allclose(turn, [0, 0, 1], atol=1e-9) and np.allclose(pose[:3, 3], [0.1, 0.2, 0], atol=1e-12)
        unchanged = unchanged and (lies if name == "Pinocchio" or (name == "DART" and not stated) else right)
    print(f"  {stated or 'none':6}", "   ".join(said))
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
