"""The calibrated robot in a planner, as with MoveIt: its description is a xacro source that takes the origins of joints from a file.

The source stays as it is; each robot of the type has a file of its own, which `poecal export --format origins` writes. The expanded
`robot_description` goes to robot_state_publisher and move_group. Here a goal is reached by iteration, as KDL's plugin does, by the nominal
description and by the calibrated one; the robot that is really there (which only a simulation knows) says where it then stands.
Needs ``pip install xacro pin``.
"""

import sys
import tempfile
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np

import poecal

try:
    import pinocchio
    import xacro
except ModuleNotFoundError:
    sys.exit("with_moveit.py needs xacro and Pinocchio: pip install xacro pin")

ELBOW = Path(__file__).parents[1] / "elbow"

# A session on a robot whose axes are off, of which the nominal description knows nothing.
nominal = poecal.Robot.read(ELBOW / "robot.urdf")
session = poecal.simulate(nominal, kind="pose", count=60, error_rotation_deg=0.1, error_position_mm=0.5, seed=3, device_frame="base")
# What is measured there is the tip of the model itself, which is off as well.
calibration = poecal.calibrate(nominal, session.measurements, device_frame="base", move_tip=True)


def source_of(urdf: str) -> str:
    """The description with the origins of its joints taken from a file, as a description package has it."""
    robot = xml.fromstring(urdf)
    robot.set("xmlns:xacro", "http://www.ros.org/wiki/xacro")
    robot.insert(0, xml.Element("xacro:arg", name="origins", default=""))
    robot.insert(1, xml.Element("xacro:property", name="o", value="${xacro.load_yaml('$(arg origins)')['origins']}"))
    for joint in robot.findall("joint"):
        number = lambda key, name=joint.get("name"): "${o['" + name + "']['" + key + "']}"  # noqa: E731
        for origin in joint.findall("origin"):
            origin.set("xyz", " ".join(map(number, ["x", "y", "z"])))
            origin.set("rpy", " ".join(map(number, ["roll", "pitch", "yaw"])))
    return xml.tostring(robot, encoding="unicode")


class Planner:
    """Inverse kinematics by damped least squares from a seed."""

    def __init__(self, urdf: str):
        self.model = pinocchio.buildModelFromXML(urdf)
        self.data = self.model.createData()
        self.tip = self.model.getFrameId(nominal.tip_link)

    def joints(self, goal: np.ndarray, seed: np.ndarray) -> np.ndarray:
        q, goal = seed.copy(), pinocchio.SE3(goal)
        for _ in range(300):
            pinocchio.framesForwardKinematics(self.model, self.data, q)
            error = pinocchio.log6(self.data.oMf[self.tip].actInv(goal)).vector
            if np.linalg.norm(error) < 1e-12:
                break
            jacobian = pinocchio.computeFrameJacobian(self.model, self.data, q, self.tip)
            q = q + jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + 1e-6 * np.eye(6), error)
        return q


urdf = (ELBOW / "robot.urdf").read_text()
with tempfile.TemporaryDirectory() as folder:
    source, origins = Path(folder) / "robot.urdf.xacro", Path(folder) / "robot_17.yaml"
    source.write_text(source_of(urdf))
    origins.write_text(calibration.export("origins"))
    description = xacro.process_file(str(source), mappings={"origins": str(origins)}).toxml()
planners = {"nominal": Planner(urdf), "calibrated": Planner(description)}

random = np.random.default_rng(2)
seeds = random.uniform(0.6 * nominal.limits[:, 0], 0.6 * nominal.limits[:, 1], (100, 6))
seeds = seeds[np.abs(seeds[:, 4]) > 0.3]  # away from the wrist's singularity
for name, planner in planners.items():
    distances = []
    for seed in seeds:
        goal = session.actual.forward_kinematics(seed)
        reached = session.actual.forward_kinematics(planner.joints(goal, seed + 0.02))
        distances.append(1e3 * np.linalg.norm(reached[:3, 3] - goal[:3, 3]))
    print(f"planned by the {name} description: the robot stands {np.mean(distances):.3f} mm from the goal (mean), {np.max(distances):.3f} mm at most")
