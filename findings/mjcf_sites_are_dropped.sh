#!/usr/bin/env bash
# The tool of an arm as a site of an MJCF model, in Drake, DART, PyBullet and kinpy.
#
# Expected: a site is a frame, as in MuJoCo and Pinocchio, where tools and sensors of most MJCF models are.
# What happens: all four read the file, move the bodies as MuJoCo does, and have no site: no frame, no body, no link.
# Drake warns that the tag is ignored, the others say nothing. A tool that is taken to be the last link is off by the
# whole site. A body without joints at the same place is read by all.
# Whom it hurts: whoever takes an arm of MuJoCo, its menagerie or an exporter to another simulator and works with the
# last body: here 0.22 m and a quarter of a turn.
# poecal: reads sites; its MJCF has the tip as a site (docs/howto/exports.md has the table of who reads it).
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check mujoco==4.0.0 drake==1.51.1 dartpy==6.20.0 pybullet==3.2.7 kinpy==0.6.1 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - 3>&1 > log.txt 2> said.txt <<'PY'
import os
import sys
from importlib.metadata import version
import dartpy
import kinpy
import mujoco
import numpy as np
import pybullet
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

out = open(3, "w", buffering=1)  # PyBullet prints to the other one
print(", ".join(f"{name} {version(name)}" for name in ("mujoco", "drake", "dartpy", "pybullet", "kinpy")), file=out)
INERTIA = '<inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>'
TOOL = 'pos="0.1 0.05 0.19" quat="0.7071067811865476 0 0.7071067811865476 0"'


def model(name, end):
    text = f"""<mujoco model="{name}"><compiler angle="radian"/><worldbody><body name="base">{INERTIA}<body name="arm" pos="0 0 0.3">{INERTIA}
      <joint name="turn" type="hinge" axis="0 0 1"/><body name="hand" pos="0.4 0 0">{INERTIA}<joint name="wrist" type="hinge" axis="0 1 0"/>{end}</body></body></body></worldbody></mujoco>"""
    with open(f"{name}.xml", "w") as file:
        file.write(text)
    return f"{name}.xml"


def by_drake(path):
    plant = MultibodyPlant(1e-3)
    Parser(plant).AddModels(path)
    plant.Finalize()
    context = plant.CreateDefaultContext()
    for name in ("turn", "wrist"):
        plant.GetJointByName(name).set_angle(context, 0.3)
    return {name: plant.GetFrameByName(name).CalcPoseInWorld(context).translation() for name in ("hand", "tool") if plant.HasFrameNamed(name)}


def by_dart(path):
    robot = dartpy.utils.MjcfParser.readWorld(os.path.abspath(path)).getSkeleton(0)
    for name in ("turn", "wrist"):
        robot.getJoint(name).setPosition(0, 0.3)
    nodes = {name: robot.getBodyNode(name) for name in ("hand", "tool")}
    return {name: np.array(node.getWorldTransform().translation()) for name, node in nodes.items() if node is not None}


def by_pybullet(path):
    body = pybullet.loadMJCF(path)[0]
    infos = [pybullet.getJointInfo(body, index) for index in range(pybullet.getNumJoints(body))]
    for info in infos:
        if info[1].decode() in ("turn", "wrist"):
            pybullet.resetJointState(body, info[0], 0.3)
    return {info[12].decode(): np.array(pybullet.getLinkState(body, info[0], computeForwardKinematics=True)[4]) for info in infos}


def by_kinpy(path):
    frames = kinpy.build_chain_from_mjcf(open(path).read()).forward_kinematics({"turn": 0.3, "wrist": 0.3})
    return {**{name: frames[name].pos for name in frames}, **({"hand": frames["hand_child"].pos} if "hand_child" in frames else {})}


def by_mujoco(path):
    made = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(made)
    data.qpos[:] = 0.3
    mujoco.mj_kinematics(made, data)
    return {"hand": data.body("hand").xpos.copy(), "tool": (data.site("tool") if made.nsite else data.body("tool")).xpos.copy()}


pybullet.connect(pybullet.DIRECT)
unchanged = True
truth = by_mujoco(model("site", f'<site name="tool" {TOOL}/>'))
print("tool behind the hand, as MuJoCo has it:", f"{np.linalg.norm(truth['tool'] - truth['hand']):.3f} m", file=out)
for words, end in (("as a site", f'<site name="tool" {TOOL}/>'), ("as a body", f'<body name="tool" {TOOL}>{INERTIA}</body>')):
    path = model(words.replace(" ", "_"), end)
    for name, reader in (("Drake", by_drake), ("DART", by_dart), ("PyBullet", by_pybullet), ("kinpy", by_kinpy)):
        found = reader(path)
        hand = np.linalg.norm(found["hand"] - truth["hand"])
        tool = f"off by {1e6 * np.linalg.norm(found['tool'] - truth['tool']):.2f} um" if "tool" in found else "not there"
        print(f"  {words}, {name:8}: hand off by {1e6 * hand:.2f} um, tool {tool}", file=out)
        unchanged = unchanged and hand < 1e-6 and ("tool" in found) == (words == "as a body")
        unchanged = unchanged and ("tool" not in found or np.linalg.norm(found["tool"] - truth["tool"]) < 1e-6)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes", file=out)
sys.exit(not unchanged)
PY
grep -ih "site" said.txt log.txt | grep -v "^WARNING:drake" && exit 1
grep -q "WARNING:drake.*'site'.*ignored" said.txt && echo "Drake warns, the others do not"
