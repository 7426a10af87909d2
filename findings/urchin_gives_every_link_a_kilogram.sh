#!/usr/bin/env bash
# A URDF without masses, loaded and saved by urchin, a fork of urdfpy.
#
# Expected: links without <inertial> stay without. Axes keep their digits, as origins do.
# What happens: each such link is written with a mass of 1 kg, an inertia of 1 kg m2 and its centre of
# gravity in its frame; frames without a body, such as a flange or a tip, weigh 1 kg too. Axes are
# brought to length one and written with eight digits, 1e-8 rad, while origins keep sixteen.
# Whom it hurts: whoever computes torques or the sag of links by the saved file. By the URDF such a link
# has no mass, and no reader can tell the invented kilogram from a real one.
# poecal: uses masses for the terms of gravity only. `poecal check` prints how many links have one, and
# the sum; it takes what the file says.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check urchin==0.0.30 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
import xml.etree.ElementTree as ElementTree
from importlib.metadata import version
import numpy as np
import urchin

print("urchin", version("urchin"))
AXIS = [0.001234567890123456, 0.002345678901234567, 0.999996486825479]
ORIGIN = [0.12345678901234567, 0.0, 0.4]
with open("given.urdf", "w") as file:
    file.write(f"""<robot name="one"><link name="base"/><link name="arm"/><link name="tip"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="{' '.join(map(repr, ORIGIN))}"/>
 <axis xyz="{' '.join(map(repr, AXIS))}"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="mount" type="fixed"><parent link="arm"/><child link="tip"/><origin xyz="0.4 0 0"/></joint></robot>""")
urchin.URDF.load("given.urdf").save("saved.urdf")
saved = ElementTree.parse("saved.urdf").getroot()
masses = {link.get("name"): float(mass.get("value")) for link in saved.iter("link") for mass in link.findall("inertial/mass")}
print("masses of links that had none, kg:", masses)
turn = saved.find("joint[@name='turn']")
axis, origin = (np.array(turn.find(name).get("xyz").split(), float) for name in ("axis", "origin"))
unit = np.array(AXIS) / np.linalg.norm(AXIS)
print(f"largest change of a number: origin {np.abs(origin - ORIGIN).max():.0e}, axis {np.abs(axis - unit).max():.0e}")
unchanged = masses == {"base": 1.0, "arm": 1.0, "tip": 1.0}
unchanged = unchanged and np.abs(origin - ORIGIN).max() < 1e-15 and 1e-12 < np.abs(axis - unit).max() < 1e-8
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
