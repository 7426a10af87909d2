"""The calibration by SciPy's least_squares, all rows at once in NumPy.

    scipy_peer.py FOLDER pose|point finite_differences|analytic

Unknowns: four numbers a joint (its axis shifted along and tilted about the two directions across it), then the tool's shift, and
with poses its rotation.
"""

import sys

import numpy as np
from numpy_problem import TOLERANCE, Robot, Rows, exp_and_jacobian, log, read, repeat, report, rms_mm, skew
from scipy.optimize import least_squares


class Calibration:
    """Residuals and Jacobian of some rows. Sines and cosines of the readings stay the same throughout a fit."""

    def __init__(self, robot: Robot, rows: Rows):
        self.robot, self.rows = robot, rows
        self.poses = len(robot.sigmas) == 6
        self.unknowns = 4 * len(robot.points) + len(robot.sigmas)
        self.sine = np.sin(rows.readings)[:, :, None, None]
        self.versine = 1 - np.cos(rows.readings)[:, :, None, None]
        self.x = None

    def chain(self, x: np.ndarray) -> None:
        """Tool rotation and position, and on the way there the rotation before each joint and where its axis' point is."""
        if self.x is not None and np.array_equal(x, self.x):
            return
        self.x, robot = x.copy(), self.robot
        n, tool = len(robot.points), x[4 * len(robot.points) :]
        shifts, tilts = x[: 4 * n].reshape(n, 2, 2).transpose(1, 0, 2)
        across = robot.frames[:, :, :2]
        turned, self.turn = exp_and_jacobian((across @ tilts[:, :, None])[..., 0])
        points = robot.points + (across @ shifts[:, :, None])[..., 0]
        hat = skew((turned @ robot.frames[:, :, 2:])[..., 0])
        joints = np.eye(3) + self.sine * hat + self.versine * (hat @ hat)

        m = len(self.rows.readings)
        rotation, origin = np.eye(3), np.zeros((m, 3))
        self.before, self.points = np.empty((n + 1, m, 3, 3)), np.empty((n, m, 3))
        self.before[0] = rotation
        for i in range(n):
            self.points[i] = origin + rotation @ points[i]
            rotation = rotation @ joints[:, i]
            origin = self.points[i] - rotation @ points[i]
            self.before[i + 1] = rotation
        self.position = origin + rotation @ (robot.home_position + robot.home_rotation @ tool[:3])
        if self.poses:
            turned, self.tool_turn = exp_and_jacobian(tool[3:])
            self.rotation = rotation @ (robot.home_rotation @ turned)

    def residuals(self, x: np.ndarray) -> np.ndarray:
        self.chain(x)
        residuals = self.rows.positions - self.position
        if self.poses:
            residuals = np.hstack([residuals, log(self.rows.rotations @ self.rotation.transpose(0, 2, 1))])
        return (residuals / self.robot.sigmas).ravel()

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """The derivative of the logarithm is taken as -1, which leaves the gradient exact (docs/theory.md, section 4)."""
        self.chain(x)
        robot = self.robot
        n, m = len(robot.points), len(self.position)
        jacobian = np.zeros((m, len(robot.sigmas), self.unknowns))
        for i in range(n):
            # What stands before the joint moves with the axis, what stands after it moves against it.
            difference = self.before[i] - self.before[i + 1]
            across = robot.frames[i, :, :2]
            tilts = difference @ (self.turn[i] @ across)
            jacobian[:, :3, 4 * i : 4 * i + 2] = difference @ across
            jacobian[:, :3, 4 * i + 2 : 4 * i + 4] = -skew(self.position - self.points[i]) @ tilts
            if self.poses:
                jacobian[:, 3:, 4 * i + 2 : 4 * i + 4] = tilts
        tool = self.before[n] @ robot.home_rotation
        jacobian[:, :3, 4 * n : 4 * n + 3] = tool
        if self.poses:
            jacobian[:, 3:, 4 * n + 3 :] = tool @ self.tool_turn
        jacobian /= -robot.sigmas[:, None]
        return jacobian.reshape(-1, self.unknowns)


def main() -> None:
    folder, mode, derivatives = sys.argv[1:]
    robot, measured, held_out = read(folder, mode)

    def fit():
        calibration = Calibration(robot, measured)
        jacobian = calibration.jacobian if derivatives == "analytic" else "2-point"
        start = np.zeros(calibration.unknowns)
        tolerances = {"ftol": TOLERANCE, "xtol": TOLERANCE, "gtol": TOLERANCE}
        # Of all methods and scalings this was the fastest, for every problem.
        return least_squares(calibration.residuals, start, jacobian, method="lm", x_scale=1.0, **tolerances)

    result, cpu_ms = repeat(fit)
    judged = Calibration(robot, held_out)
    judged.chain(result.x)
    # Evaluations less that of the start. SciPy before 1.16 counts those for differences too.
    report(cpu_ms, result.nfev - 1, rms_mm(judged.position - held_out.positions))


main()
