#!/usr/bin/env bash
# Inverse kinematics of a robot given as a URDF, in EAIK.
#
# Expected: UrdfRobot solves for poses of a frame of the URDF, the last link or the tool; at joint values
# from there the URDF has the pose that was asked for.
# What happens: the end is the last moving joint, whatever fixed joints follow, and its orientation at zero
# is taken to be that of the base, whatever the URDF says. fwdKin has another orientation than the URDF
# by a constant turn, and IK answers a pose of the URDF with up to eight solutions, exact ones by its own
# account, of which none has that pose. The documentation asks for the file only.
# Whom it hurts: whoever sends an arm to poses from ROS, MoveIt, a calibration or a camera: wrists of most
# URDFs are turned at zero. Multiply poses by the inverse of the URDF's pose at zero, its rotation.
# poecal: predicts the pose of the frame named by --tip-link, with its orientation and all fixed joints.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check EAIK==1.2.2 pin==4.1.0 urchin==0.0.30 numpy==2.4.6 scipy==1.17.1
cd "$here"
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
import pinocchio
from eaik.IK_URDF import UrdfRobot
from scipy.spatial.transform import Rotation

print("EAIK", version("EAIK"), "beside pinocchio", pinocchio.__version__)
QUARTER = 1.5707963267948966
ORIGINS = (  # x y z, and the turn about x and y: an arm with a spherical wrist, all axes z
    ("0 0 0.3", "0 0 0"), ("0.1 0 0.2", f"{QUARTER} 0 0"), ("0.6 0 0", "0 0 0"),
    ("0.1 0.05 0", f"0 {-QUARTER} 0"), ("0 0 0.6", f"0 {QUARTER} 0"), ("0 0 0", f"0 {-QUARTER} 0"),
)
text = '<robot name="arm"><link name="link0"/>'
for number, (place, turn) in enumerate(ORIGINS, 1):
    text += f"""<link name="link{number}"/><joint name="joint{number}" type="revolute"><parent link="link{number - 1}"/>
     <child link="link{number}"/><origin xyz="{place}" rpy="{turn}"/><axis xyz="0 0 1"/>
     <limit lower="-3.1" upper="3.1" effort="1" velocity="1"/></joint>"""
text += """<link name="tool"/><joint name="mount" type="fixed"><parent link="link6"/><child link="tool"/>
 <origin xyz="0 0 0.1"/></joint></robot>"""
with open("arm.urdf", "w") as file:
    file.write(text)
model = pinocchio.buildModelFromXML(text)
data = model.createData()


def by_urdf(values, link):
    pinocchio.framesForwardKinematics(model, data, np.asarray(values))
    return data.oMf[model.getFrameId(link)].homogeneous


def misses(got, wanted):
    turn = Rotation.from_matrix(wanted[:3, :3].T @ got[:3, :3]).magnitude()
    return 1000 * np.linalg.norm(got[:3, 3] - wanted[:3, 3]), np.degrees(turn)


robot = UrdfRobot("arm.urdf")
values = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
zero = np.eye(4)
zero[:3, :3] = by_urdf(np.zeros(6), "link6")[:3, :3]
for link in ("link6", "tool"):
    place, turn = misses(robot.fwdKin(values), by_urdf(values, link))
    print(f"fwdKin and {link:5} of the URDF apart: {place:7.3f} mm, {turn:7.3f} deg")
place, turn = misses(robot.fwdKin(values), by_urdf(values, "link6"))
unchanged = place < 1e-9 and turn > 90 and misses(robot.fwdKin(values), by_urdf(values, "tool"))[0] > 99
unchanged = unchanged and misses(robot.fwdKin(values) @ zero, by_urdf(values, "link6"))[1] < 1e-5

wanted = by_urdf(values, "link6")
for name, asked in (("the pose of link6", wanted), ("that pose, turned back by the pose at zero", wanted @ np.linalg.inv(zero))):
    solution = robot.IK(asked)
    best = min(misses(by_urdf(each, "link6"), wanted)[1] for each in solution.Q)
    exact = len(solution.Q) - sum(map(bool, solution.is_LS))
    print(f"IK of {name}: {len(solution.Q)} solutions, {exact} exact; the best of them is off by {best:.3f} deg")
    unchanged = unchanged and exact == 8 and (best > 10 if asked is wanted else best < 1e-5)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
