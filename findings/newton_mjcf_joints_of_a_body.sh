#!/usr/bin/env bash
# An MJCF body with several joints, in Newton beside MuJoCo.
#
# Expected: add_mjcf and eval_fk put bodies where MuJoCo does, to the digits of float32, since MuJoCo is one of
# Newton's solvers. For bodies with one joint they do, and for two or three hinges at one point.
# What happens: the joints of a body become one joint, whose slides come first, whatever the order in the file:
# a hinge before a slide turns after it, and the slide goes along the axis of the parent. Its coordinates
# change places too: joint_q has the slide first. Joints at two points of a body are put at one. Nothing is
# said.
# Whom it hurts: whoever takes a robot of MuJoCo to Newton: a turntable with a slide on it, a universal joint
# whose axes do not meet, a wrist. A body for each joint helps.
# poecal: places the joints as MuJoCo does.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check newton==1.8.0 warp-lang==1.19.0 mujoco==4.0.0 numpy==2.4.6
WARP_CACHE_PATH="$here/cache" "$here/venv/bin/python" -W ignore - <<'PY'
import logging
import sys
from importlib.metadata import version
import mujoco
import numpy as np
import warp

warp.config.quiet = True
logging.disable(logging.WARNING)
import newton

print("Newton", version("newton"), "and MuJoCo", mujoco.__version__)
MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def model(*joints):
    text = "".join(f'<joint name="joint{number}" {joint}/>' for number, joint in enumerate(joints))
    return f"""<mujoco><compiler angle="radian"/><worldbody><body name="arm" pos="0 0 0.5" euler="0.3 0.2 0.4">{MASS}{text}
    <body name="tool" pos="1 0 0">{MASS}</body></body></worldbody></mujoco>"""


def by_mujoco(text, values):
    one = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(one)
    data.qpos[:] = values
    mujoco.mj_kinematics(one, data)
    return data.body("tool").xpos.copy()


def by_newton(text, values):
    builder = newton.ModelBuilder()
    builder.add_mjcf(text)
    one = builder.finalize(device="cpu")
    assert one.joint_coord_count == len(values)
    state = one.state()
    newton.eval_fk(one, warp.array(values, dtype=warp.float32, device="cpu"), one.joint_qd, state)
    names = [str(name).split("/")[-1] for name in one.body_label]
    return state.body_q.numpy()[names.index("tool")][:3]


X, Y, Z = 'axis="1 0 0"', 'axis="0 1 0"', 'axis="0 0 1"'
SLIDE = 'type="slide" axis="1 0 0"'
CASES = {
    "one hinge": ([Z], [0.5], None, False),
    "three hinges": ([Z, Y, X], [0.5, 0.4, 0.3], None, False),
    "slide, then hinge": ([SLIDE, Z], [0.4, 0.5], None, False),
    "hinge, then slide": ([Z, SLIDE], [0.5, 0.4], None, True),
    "hinge, then slide, values exchanged": ([Z, SLIDE], [0.5, 0.4], [0.4, 0.5], True),
    "two hinges at two points": ([Z + ' pos="0.1 0 0"', Y + ' pos="0 0 0.2"'], [0.5, 0.4], None, True),
}
unchanged = True
print("tool at 1 m, Newton and MuJoCo apart:")
for name, (joints, values, others, differ) in CASES.items():
    text = model(*joints)
    apart = 1000 * np.linalg.norm(by_newton(text, others or values) - by_mujoco(text, values))
    print(f"  {name:38} {apart:10.3f} mm")
    unchanged = unchanged and (apart > 10 if differ else apart < 1e-2)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
