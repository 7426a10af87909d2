#!/usr/bin/env bash
# Corrections of a calibration, written into an MJCF robot with MuJoCo's MjSpec.
#
# Expected: an orientation that is set as body.quat is that of the compiled model, and an offset that is set as
# joint.ref, in radians as qpos is, moves the tool by itself.
# What happens: body.quat counts where the file has a quaternion or nothing. Where it has euler, axisangle,
# xyaxes or zaxis, body.quat reads 1 0 0 0 before and after compiling, and what is set is dropped: the model
# has the orientation of the file. joint.ref and joint.range are in degrees if the file says nothing of
# angles, and in a spec made by MjSpec() too: 20 mrad become 0.35 mrad. Nothing is said in either case. Set
# body.alt.type to mjORIENTATION_QUAT as well, and look at spec.compiler.degree.
# Whom it hurts: whoever puts a calibrated robot into MuJoCo by its API: positions are corrected, and turns,
# which matter more, are not.
# poecal: writes an MJCF file with pos and quat of each body (`poecal export --format mjcf`), to be loaded as it is.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check mujoco==4.0.0 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" - <<'PY'
import sys
import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

print("MuJoCo", mujoco.__version__)
MASS = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
CORRECTION = 0.02  # rad, about z


def spec_of(orientation, compiler=""):
    return mujoco.MjSpec.from_string(f"""<mujoco>{compiler}<worldbody><body name="arm" pos="0 0 0.5" {orientation}>{MASS}
      <joint name="turn" axis="0 0 1"/><body name="tool" pos="1 0 0">{MASS}</body></body></worldbody></mujoco>""")


def tool(spec):
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[:] = 0
    mujoco.mj_kinematics(model, data)
    return data.body("tool").xpos.copy()


unchanged = True
print(f"the orientation of a body, turned by {1000 * CORRECTION:.0f} mrad as body.quat; tool at 1 m:")
for orientation, counts in (
    ("", True),
    ('quat="0.6 0 0 0.8"', True),
    ('euler="0 0 106.26020470831195"', False),
    ('axisangle="0 0 1 106.26020470831195"', False),
    ('xyaxes="-0.28 0.96 0 -0.96 -0.28 0"', False),
    ('zaxis="0.6 0 0.8"', False),
):
    before = tool(spec_of(orientation))
    spec = spec_of(orientation)
    nominal = Rotation.from_quat(spec.compile().body("arm").quat, scalar_first=True)
    arm = spec.body("arm")
    read = Rotation.from_quat(arm.quat, scalar_first=True)
    arm.quat = (Rotation.from_rotvec([0, 0, CORRECTION]) * nominal).as_quat(scalar_first=True)
    moved = np.linalg.norm(tool(spec) - before)
    print(f"  {orientation or 'nothing stated':38} read off by {(read.inv() * nominal).magnitude():.2f} rad, tool moved by {1000 * moved:.2f} mm")
    unchanged = unchanged and (moved > 0.01 if counts else moved == 0)
print(f"the zero of a joint, moved by {CORRECTION} as joint.ref:")
for compiler in ('<compiler angle="radian"/>', ""):
    before = tool(spec_of("", compiler))
    spec = spec_of("", compiler)
    spec.joint("turn").ref = CORRECTION
    moved = np.linalg.norm(tool(spec) - before)
    print(f"  {compiler or 'nothing stated':38} tool moved by {1000 * moved:.2f} mm")
    unchanged = unchanged and abs(moved - (CORRECTION if compiler else np.radians(CORRECTION))) < 1e-5
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
