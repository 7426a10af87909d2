#!/usr/bin/env bash
# An SDF whose links are placed in other links, in PyBullet.
#
# Expected: PyBullet reads SDF, so that `relative_to` of a pose, which SDF has had since 1.7, counts, as in Drake; or
# the file is refused by its version.
# What happens: `relative_to` is passed over, and each pose is taken to be in the model's frame. Links are strewn
# about, the second axis of two is at the height of the first one, and nothing is said but by the picture.
# The same links with poses in the model's frame, which all versions have, are read as Drake reads them.
# Whom it hurts: whoever takes a model of today's Gazebo, or of an exporter that chains its links, into PyBullet.
# poecal: reads `relative_to`, and writes it in its own SDF (docs/howto/exports.md has the table of who reads that).
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pybullet==3.2.7 drake==1.51.1 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
import pybullet
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

print("PyBullet", version("pybullet"), "beside Drake", version("drake"))
INERTIA = "<inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"
JOINT = '<joint name="{}" type="revolute"><parent>{}</parent><child>{}</child><axis><xyz>0 0 1</xyz><limit><lower>-2</lower><upper>2</upper></limit></axis></joint>'


def model(version, place, of_arm, of_hand):
    links = f'<link name="base">{INERTIA}</link><link name="arm"><pose{of_arm}>0 0 0.5 0 0 0</pose>{INERTIA}</link>'
    links += f'<link name="hand"><pose{of_hand}>{place} 0 0 0</pose>{INERTIA}</link>'
    return f'<?xml version="1.0"?><sdf version="{version}"><model name="two">{links}{JOINT.format("j1", "base", "arm")}{JOINT.format("j2", "arm", "hand")}</model></sdf>'


def by_drake(path):
    plant = MultibodyPlant(1e-3)
    Parser(plant).AddModels(path)
    plant.Finalize()
    context = plant.CreateDefaultContext()
    plant.GetJointByName("j1").set_angle(context, 0.3)
    base = plant.GetFrameByName("base").CalcPoseInWorld(context)
    return (base.inverse() @ plant.GetFrameByName("hand").CalcPoseInWorld(context)).translation()


def by_pybullet(path):
    body = pybullet.loadSDF(path)[0]
    infos = [pybullet.getJointInfo(body, index) for index in range(pybullet.getNumJoints(body))]
    number = {info[12].decode(): info[0] for info in infos}
    pybullet.resetJointState(body, number["arm"], 0.3)
    return np.array(pybullet.getLinkState(body, number["hand"], computeForwardKinematics=True)[4])


pybullet.connect(pybullet.DIRECT)
unchanged = True
right = np.array([0.4 * np.cos(0.3), 0.4 * np.sin(0.3), 0.7])
print("hand at 0.3 rad of the first joint; it is 0.4 m beside the arm and 0.2 m above it")
for number, words in enumerate((("1.9", "0.4 0 0.2", ' relative_to="base"', ' relative_to="arm"'), ("1.9", "0.4 0 0.7", "", ""), ("1.6", "0.4 0 0.7", "", ""))):
    path = f"two{number}.sdf"
    with open(path, "w") as file:
        file.write(model(*words))
    found = by_pybullet(path), by_drake(path)
    off = [1000 * np.linalg.norm(place - right) for place in found]
    print(f"  SDF {words[0]}, {'poses in the links before' if words[2] else 'poses in the model':26} PyBullet off by {off[0]:7.3f} mm, Drake by {off[1]:.3f} mm")
    unchanged = unchanged and off[1] < 1e-9 and (off[0] > 400 if words[2] else off[0] < 1e-3)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
