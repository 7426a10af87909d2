#!/usr/bin/env bash
# A URDF with a mimic joint, loaded and written again by yourdfpy.
#
# Expected: write_xml_file writes the robot that was loaded. The loaded one follows <mimic> in forward
# kinematics.
# What happens: <mimic>, <calibration> and <safety_controller> are not written. The file is a valid URDF
# of another robot: one more joint moves by itself, and stays at zero where only the leader is set.
# Whom it hurts: whoever edits a URDF with it, changes paths of meshes or corrects origins: parallel
# linkages, coupled fingers and torsos come apart, and nothing says so until something is measured.
# poecal: follows <mimic>, and changes nothing but numbers of <origin> and <axis> in the text of a URDF.
# Of a file from here it cannot know; `poecal check` shows the follower as a joint that wants readings.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check yourdfpy==0.0.60 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
import yourdfpy

print("yourdfpy", version("yourdfpy"))
LIMIT = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'
with open("given.urdf", "w") as file:
    file.write(f"""<robot name="parallel"><link name="base"/><link name="upper"/><link name="fore"/><link name="tool"/>
<joint name="lead" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>{LIMIT}</joint>
<joint name="follow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>{LIMIT}
 <mimic joint="lead" multiplier="-1" offset="0.1"/><calibration rising="0.2"/>
 <safety_controller soft_lower_limit="-1" soft_upper_limit="1" k_position="1" k_velocity="1"/></joint>
<joint name="mount" type="fixed"><parent link="fore"/><child link="tool"/><origin xyz="0.4 0 0"/></joint></robot>""")
given = yourdfpy.URDF.load("given.urdf")
given.write_xml_file("written.urdf")
written = yourdfpy.URDF.load("written.urdf")
with open("given.urdf") as one, open("written.urdf") as other:
    texts = one.read(), other.read()
lost = [name for name in ("mimic", "calibration", "safety_controller", "limit", "axis") if f"<{name}" in texts[0] and f"<{name}" not in texts[1]]
print("elements that were not written:", ", ".join(lost))
print("joints that move by themselves:", given.actuated_joint_names, "->", written.actuated_joint_names)
tools = []
for robot in (given, written):
    robot.update_cfg({"lead": 0.6})
    tools.append(robot.get_transform("tool", "base")[:3, 3])
apart = 1000 * np.linalg.norm(tools[0] - tools[1])
print(f"tool with the leader at 0.6 rad: {apart:.1f} mm apart")
unchanged = lost == ["mimic", "calibration", "safety_controller"] and apart > 100
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
