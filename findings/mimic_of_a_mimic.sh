#!/usr/bin/env bash
# A URDF joint that follows a follower, in yourdfpy, urchin, COMPAS and scikit-robot.
#
# Expected: a follower takes multiplier times its leader plus offset, also where the leader is a follower
# itself; or the file is refused, as by pinocchio. For single followers all four agree.
# What happens: scikit-robot follows the chain. yourdfpy takes the value that was set for the leader in
# the chain, which is zero, since a follower takes no value; urchin and compas_robots leave the second
# follower at zero, without its offset. Three libraries put the tool at two wrong places, and nothing
# is said.
# Whom it hurts: whoever has a telescope of three stages, a finger or a linkage whose joints copy one
# another in turn. The URDF specification does not say that a leader must move by itself.
# poecal: follows the chain to the leader that has readings.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check yourdfpy==0.0.60 urchin==0.0.30 \
  compas_robots==1.0.1 compas==2.15.1 scikit-robot==0.4.7 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import math
import sys
from importlib.metadata import version
import numpy as np
import urchin
import yourdfpy
from compas_robots import RobotModel
from skrobot.models.urdf import RobotModelFromURDF

print(", ".join(f"{name} {version(name)}" for name in ("yourdfpy", "urchin", "compas_robots", "scikit-robot")))
LIMIT = '<limit lower="-3" upper="3" effort="1" velocity="1"/>'
FOLLOWERS = {"second": ("first", 2.0, 0.1), "third": ("second", -1.0, 0.2)}


def robot(names):
    """Joints about z, each link 0.3 m long."""
    text = '<robot name="fingers"><link name="base"/>'
    parent = "base"
    for name in names:
        place = 0.0 if parent == "base" else 0.3
        mimic = '<mimic joint="{}" multiplier="{}" offset="{}"/>'.format(*FOLLOWERS[name]) if name in FOLLOWERS else ""
        text += f"""<link name="of_{name}"/><joint name="{name}" type="revolute"><parent link="{parent}"/><child link="of_{name}"/>
         <origin xyz="{place} 0 0"/><axis xyz="0 0 1"/>{LIMIT}{mimic}</joint>"""
        parent = f"of_{name}"
    return text + f"""<link name="tool"/><joint name="mount" type="fixed"><parent link="{parent}"/><child link="tool"/>
     <origin xyz="0.3 0 0"/></joint></robot>"""


def right(names, first):
    values = {"first": first}
    for name, (leader, multiplier, offset) in FOLLOWERS.items():
        values[name] = multiplier * values[leader] + offset
    angles = np.cumsum([values[name] for name in names])
    return 0.3 * np.array([sum(map(math.cos, angles)), sum(map(math.sin, angles)), 0])


def by_yourdfpy(text, first):
    one = yourdfpy.URDF.load("robot.urdf")
    one.update_cfg({"first": first})
    return one.get_transform("tool", "base")[:3, 3]


def by_urchin(text, first):
    return urchin.URDF.load("robot.urdf").link_fk({"first": first}, use_names=True)["tool"][:3, 3]


def by_compas(text, first):
    one = RobotModel.from_urdf_string(text)
    return np.array(one.forward_kinematics({"first": first}, link_name="tool").point)


def by_skrobot(text, first):
    one = RobotModelFromURDF(urdf=text)
    one.first.joint_angle(first)
    return np.array(one.tool.worldpos()) - np.array(one.base.worldpos())


unchanged = True
readers = {"yourdfpy": by_yourdfpy, "urchin": by_urchin, "compas_robots": by_compas, "scikit-robot": by_skrobot}
wrong = {}
for names in (("first", "second"), ("first", "second", "third")):
    text = robot(names)
    with open("robot.urdf", "w") as file:
        file.write(text)
    print(f"leader at 0.2 rad, {len(names) - 1} follower{'s' if len(names) > 2 else ''}:")
    for name, reader in readers.items():
        place = np.array(reader(text, 0.2), float)
        miss = 1000 * np.linalg.norm(place - right(names, 0.2))
        print(f"  {name:14} tool at {place[0]:.4f} {place[1]:.4f}, off by {miss:7.3f} mm")
        if len(names) == 3 and name != "scikit-robot":
            wrong[name] = place
            unchanged = unchanged and miss > 50
        else:
            unchanged = unchanged and miss < 1e-6
unchanged = unchanged and np.allclose(wrong["urchin"], wrong["compas_robots"], atol=1e-9)
unchanged = unchanged and not np.allclose(wrong["urchin"], wrong["yourdfpy"], atol=0.01)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
