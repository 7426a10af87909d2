#!/usr/bin/env bash
# An MJCF joint with a reference (`ref`), in seven readers.
#
# Expected: `ref` is the value of the joint in the pose that the file draws, so that a value counts from there, as in
# MuJoCo; or the file is refused.
# What happens: Pinocchio and Drake count as MuJoCo does. Newton, DART, kinpy and PyBullet drop `ref`, and take the drawn
# pose for zero: a hinge with a `ref` of 0.2 rad is 200 mm off at 1 m, a slide 200 mm for 0.2 m, at every value. Nothing is
# said. Newton has MuJoCo among its solvers.
# Whom it hurts: whoever writes the offset of a joint's zero, as a calibration finds it, where MJCF has a place for it.
# poecal: reads `ref` (docs/file-formats.md), and writes none: its MJCF has offsets in the poses of the bodies, which all
# seven read.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check mujoco==4.0.0 pin==4.1.0 drake==1.51.1 newton==1.8.0 warp-lang==1.19.0 \
  dartpy==6.20.0 kinpy==0.6.1 pybullet==3.2.7 numpy==2.4.6
cd "$here"
WARP_CACHE_PATH="$here/cache" "$here/venv/bin/python" -W ignore - <<'PY'
import contextlib
import io
import logging
import os
import sys
from importlib.metadata import version
import dartpy
import kinpy
import mujoco
import numpy as np
import pinocchio
import pybullet
import warp
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

warp.config.quiet = True
logging.disable(logging.WARNING)
import newton

print(", ".join(f"{name} {version(name)}" for name in ("mujoco", "pin", "drake", "newton", "dartpy", "kinpy", "pybullet")))
MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def by_mujoco(path, value):
    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    data.qpos[:] = value
    mujoco.mj_kinematics(model, data)
    return data.body("tool").xpos.copy()


def by_pinocchio(path, value):
    model = pinocchio.buildModelFromMJCF(path)
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, np.array([value]))
    return data.oMf[model.getFrameId("tool")].translation


def by_drake(path, value):
    plant = MultibodyPlant(1e-3)
    Parser(plant).AddModels(path)
    plant.Finalize()
    context = plant.CreateDefaultContext()
    plant.SetPositions(context, [value])
    return plant.GetFrameByName("tool").CalcPoseInWorld(context).translation()


def by_newton(path, value):
    builder = newton.ModelBuilder()
    builder.add_mjcf(path)
    model = builder.finalize(device="cpu")
    state = model.state()
    newton.eval_fk(model, warp.array([value], dtype=warp.float32, device="cpu"), model.joint_qd, state)
    names = [str(name).split("/")[-1] for name in model.body_label]
    return state.body_q.numpy()[names.index("tool")][:3]


def by_dart(path, value):
    robot = dartpy.utils.MjcfParser.readWorld(path).getSkeleton(0)
    robot.setPositions([value])
    return robot.getBodyNode("tool").getWorldTransform().translation()


def by_kinpy(path, value):
    with open(path) as file:
        chain = kinpy.build_chain_from_mjcf(file.read())
    poses = chain.forward_kinematics({name: value for name in chain.get_joint_parameter_names()})
    return [pose.pos for name, pose in poses.items() if "tool" in name][-1]


def by_pybullet(path, value):
    body = pybullet.loadMJCF(path)[-1]
    infos = [pybullet.getJointInfo(body, index) for index in range(pybullet.getNumJoints(body))]
    for info in infos:
        if info[2] in (pybullet.JOINT_REVOLUTE, pybullet.JOINT_PRISMATIC):
            pybullet.resetJointState(body, info[0], value)
    number = next(info[0] for info in infos if info[12] == b"tool")
    return np.array(pybullet.getLinkState(body, number, computeForwardKinematics=True)[4])


pybullet.connect(pybullet.DIRECT)
READERS = {"Pinocchio": by_pinocchio, "Drake": by_drake, "Newton": by_newton, "DART": by_dart, "kinpy": by_kinpy, "PyBullet": by_pybullet}
CASES = {"hinge": 'type="hinge"', "hinge, ref 0.2 rad": 'type="hinge" ref="0.2"', "slide": 'type="slide"', "slide, ref 0.2 m": 'type="slide" ref="0.2"'}
unchanged = True
print("apart from MuJoCo, mm, a tool at 1 m whose joint is at 0.2 and 0.5")
for number, (name, joint) in enumerate(CASES.items()):
    path = os.path.abspath(f"arm{number}.xml")
    with open(path, "w") as file:
        file.write(f"""<mujoco model="arm"><compiler angle="radian"/><worldbody><body name="arm" pos="0 0 0.5">{MASS}
 <joint name="joint" axis="0 0 1" {joint}/><body name="tool" pos="1 0 0">{MASS}</body></body></worldbody></mujoco>""")
    said = []
    for reader, read in READERS.items():
        with contextlib.redirect_stdout(io.StringIO()):   # Newton says what it compiles
            off = [1000 * np.linalg.norm(np.asarray(read(path, value)) - by_mujoco(path, value)) for value in (0.2, 0.5)]
        said.append(f"{reader} {off[0]:.1f} {off[1]:.1f}")
        dropped = "ref" in name and reader not in ("Pinocchio", "Drake")
        unchanged = unchanged and all(abs(it - 200) < 0.5 if dropped else it < 1e-3 for it in off)
    print(f"  {name:19}", "  ".join(said))
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
