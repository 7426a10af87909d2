#!/usr/bin/env bash
# An MJCF model that is read, changed and written by MuJoCo.
#
# Expected: MuJoCo computes in double precision, and what MjSpec.to_xml and mj_saveLastXML write is the same model.
# What happens: numbers are written with six digits, without a choice and without a word. For an arm at the origin the
# tip is off by two micrometres; bodies in coordinates of a hall, 123.456789 m away, move by 0.2 mm, and an axis by
# 5e-7 rad. Each file that is read and written loses the digits for good.
# Whom it hurts: whoever edits a calibrated cell, or a model with a survey's coordinates, by MjSpec and saves it. The
# compiled model (mj_saveModel) keeps all digits.
# poecal: writes the shortest numbers that are read back as they were.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check mujoco==4.0.0 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import re
import sys
import mujoco
import numpy as np

print("MuJoCo", mujoco.__version__)


def model(place):
    return f"""<mujoco><worldbody><body name="arm" pos="{place}" quat="0.999998 0.0012345678 0.0009876543 0.0011111111">
      <joint name="turn" axis="0.0009876543 0.0012345678 1"/><geom size=".1" mass="1"/><site name="tip" pos="1.23456789 0 0"/></body></worldbody></mujoco>"""


def tip(text):
    made = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(made)
    data.qpos[0] = 0.5
    mujoco.mj_kinematics(made, data)
    return data.site("tip").xpos.copy()


unchanged = True
for place, least, most in (("0.456789123 0.321987654 0.234567891", 1e-7, 3e-6), ("123.456789 98.7654321 1.23456789", 1e-4, 4e-4)):
    text = model(place)
    spec = mujoco.MjSpec.from_string(text)
    spec.compile()
    again = spec.to_xml()
    mujoco.mj_saveLastXML("last.xml", mujoco.MjModel.from_xml_string(text))
    off = [np.linalg.norm(tip(it) - tip(text)) for it in (again, open("last.xml").read())]
    print(f'  pos="{place}" is written as', re.search(r'<body name="arm" (pos="[^"]*")', again)[1], f"- tip off by {1e6 * off[0]:.2f} and {1e6 * off[1]:.2f} um")
    unchanged = unchanged and all(least < it < most for it in off)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
