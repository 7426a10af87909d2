"""The calibration by Pinocchio's kinematic regressor and Gauss-Newton in NumPy; poses alone.

    pinocchio_peer.py FOLDER pose

Unknowns: four numbers a joint (its placement shifted along and turned about its x and y) and six of the tool. After each step the
placements are moved and the next step starts from zero, so that the regressor is the whole Jacobian. The derivative of the
logarithm is taken as -1, which leaves the gradient exact (docs/theory.md, section 4).
"""

import sys

import numpy as np
import pinocchio as pin
from numpy_problem import TOLERANCE, Robot, Rows, read, repeat, report, rms_mm

ACROSS = (0, 1, 3, 4)  # shifts along and turns about x and y, of the six numbers of a motion
MOST_ITERATIONS = 50


class Chain:
    """A Pinocchio model whose joints turn about the z of their placement, which is the axis."""

    def __init__(self, robot: Robot):
        axes = [pin.SE3(frame, point) for frame, point in zip(robot.frames, robot.points)]
        axes.append(pin.SE3(robot.home_rotation, robot.home_position))
        self.model = pin.Model()
        joint, before = 0, pin.SE3.Identity()
        for i, axis in enumerate(axes[:-1]):
            joint = self.model.addJoint(joint, pin.JointModelRZ(), before.actInv(axis), f"joint{i + 1}")
            before = axis
        tool = pin.Frame("tool", joint, 0, before.actInv(axes[-1]), pin.FrameType.OP_FRAME)
        self.tool = self.model.addFrame(tool)
        self.data = self.model.createData()
        self.columns = [6 * i + k for i in range(joint) for k in ACROSS]

    def pose(self, readings: np.ndarray) -> pin.SE3:
        pin.forwardKinematics(self.model, self.data, readings)
        return pin.updateFramePlacement(self.model, self.data, self.tool)

    def regressor(self) -> np.ndarray:
        """Of the last pose: motion of the tool, in the base's axes, by each unknown of a joint."""
        whole = pin.computeFrameKinematicRegressor(self.model, self.data, self.tool, pin.LOCAL_WORLD_ALIGNED)
        return whole[:, self.columns]

    def move(self, step: np.ndarray) -> None:
        motions = np.zeros((self.model.njoints - 1, 6))
        motions[:, ACROSS] = step[:-6].reshape(-1, 4)
        for joint, motion in enumerate(motions, start=1):
            self.model.jointPlacements[joint] = self.model.jointPlacements[joint] * pin.exp6(motion)
        frame = self.model.frames[self.tool]
        frame.placement = frame.placement * pin.SE3(pin.exp3(step[-3:]), step[-6:-3])


def linearise(chain: Chain, rows: Rows, sigmas: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Whitened residuals, and the derivative of the predictions."""
    m, unknowns = len(rows.readings), len(chain.columns) + 6
    residuals, jacobian = np.empty((m, 6)), np.zeros((m, 6, unknowns))
    for row in range(m):
        pose = chain.pose(rows.readings[row])
        rotation = pose.rotation
        residuals[row, :3] = rows.positions[row] - pose.translation
        residuals[row, 3:] = pin.log3(rows.rotations[row] @ rotation.T)
        jacobian[row, :, :-6] = chain.regressor()
        jacobian[row, :3, -6:-3] = rotation
        jacobian[row, 3:, -3:] = rotation
    residuals /= sigmas
    jacobian /= sigmas[:, None]
    return residuals.ravel(), jacobian.reshape(-1, unknowns)


def fit(robot: Robot, rows: Rows) -> tuple[Chain, int]:
    chain = Chain(robot)
    for iteration in range(1, MOST_ITERATIONS + 1):
        residuals, jacobian = linearise(chain, rows, robot.sigmas)
        gradient, normal = jacobian.T @ residuals, jacobian.T @ jacobian
        scale = 1 / np.sqrt(np.diag(normal))
        step = scale * np.linalg.solve(normal * scale * scale[:, None], scale * gradient)
        chain.move(step)
        if gradient @ step <= TOLERANCE * (residuals @ residuals):
            break
    return chain, iteration


def main() -> None:
    folder, mode = sys.argv[1:]
    robot, measured, held_out = read(folder, mode)
    (chain, iterations), cpu_ms = repeat(lambda: fit(robot, measured))
    positions = np.array([chain.pose(readings).translation for readings in held_out.readings])
    report(cpu_ms, iterations, rms_mm(positions - held_out.positions))


main()
