#!/usr/bin/env bash
# A URDF joint with <mimic>, converted to MJCF and USD by urdf2any.
#
# Expected: the follower becomes an equality of MuJoCo, as in other converters, or a warning says that it does not.
# What happens: to USD it is dropped with the warning that mimic is not supported yet. To MJCF it is dropped as well,
# and nothing is said, with -v either: the follower is a joint of its own with a motor of its own, that holds it at
# zero, without its offset.
# Whom it hurts: whoever simulates a gripper, a parallelogram or a telescope: fingers that close on one side only,
# or a tip that is off by decimetres. MuJoCo's own reading of the URDF keeps the equality, and adds no motors.
# poecal: its MJCF and SDF hold followers; USD is refused for them, in words.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check urdf2any==0.3.0 mujoco==4.0.0 usd-core==26.11 numpy==2.4.6
cd "$here"
INERTIA='<inertial><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial>'
LIMIT='<limit lower="-2" upper="2" effort="1" velocity="1"/>'
cat > arm.urdf <<URDF
<robot name="arm"><link name="l0">$INERTIA</link><link name="l1">$INERTIA</link><link name="l2">$INERTIA</link>
<joint name="leader" type="revolute"><parent link="l0"/><child link="l1"/><origin xyz="0 0 0.3"/><axis xyz="0 0 1"/>$LIMIT</joint>
<joint name="follower" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>$LIMIT
<mimic joint="leader" multiplier="-1" offset="0.2"/></joint></robot>
URDF
"$here/venv/bin/urdf2any" arm.urdf -o arm.xml -v > log.txt 2>&1
"$here/venv/bin/urdf2any" arm.urdf -o arm.usda > usd.txt 2>&1
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import mujoco

print(", ".join(f"{name} {version(name)}" for name in ("urdf2any", "mujoco", "usd-core")))
counts = {}
for name, path in (("urdf2any", "arm.xml"), ("MuJoCo itself", "arm.urdf")):
    model = mujoco.MjModel.from_xml_path(path)
    motors = [model.actuator(index).name for index in range(model.nu)]
    counts[name] = model.neq, len(motors)
    print(f"  {name:22} equalities of joints {model.neq}, motors {motors}")
says = {name: "mimic is not supported" in open(name).read() for name in ("log.txt", "usd.txt")}
print(f"  a warning to MJCF: {says['log.txt']}, to USD: {says['usd.txt']}")
unchanged = counts == {"urdf2any": (0, 2), "MuJoCo itself": (1, 0)} and says == {"log.txt": False, "usd.txt": True}
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
