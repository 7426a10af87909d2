"""Those who compute inverse kinematics. Each is made of an arm and gives a function, or None of an arm that it refuses; the function takes
targets (m, 4, 4) and configurations to begin with (m, n), adds microseconds to a list, and gives for each target its configurations."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from time import perf_counter
from types import ModuleType

import numpy as np

Solve = Callable[[np.ndarray, np.ndarray, list], Iterable[np.ndarray]]

# Steps of Pinocchio's iteration, its damping, and what is left where it ends: those of its example "inverse kinematics", but for the step
# (whole instead of a tenth) and the end (as far as poecal goes).
STEPS, DAMPING, END = 100, 1e-12, 1e-12


@dataclass
class Arm:
    """Axes by directions and points, and the tip, where all joints are at zero."""

    kind: str
    calibrated: bool
    directions: list
    points: list
    tip: list
    turned: list

    @property
    def name(self) -> str:
        return self.kind + (", calibrated" if self.calibrated else "")

    @property
    def home(self) -> np.ndarray:
        home = np.eye(4)
        home[:3, :3], home[:3, 3] = self.turned, self.tip
        return home

    def forward_kinematics(self, q: np.ndarray) -> np.ndarray:
        pose = np.eye(4)
        for w, p, angle in zip(np.array(self.directions), np.array(self.points), q, strict=True):
            hat = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
            turn = np.eye(4)
            turn[:3, :3] += np.sin(angle) * hat + (1 - np.cos(angle)) * hat @ hat
            turn[:3, 3] = p - turn[:3, :3] @ p
            pose = pose @ turn
        return pose @ self.home

    def steps(self) -> np.ndarray:
        """From each point to the next, from the base to the tip."""
        places = np.array([[0.0, 0.0, 0.0], *self.points, self.tip])
        return np.diff(places, axis=0)


def one_by_one(solve: Callable, prepared: Callable = lambda target: target) -> Solve:
    """Of a function of one target and one configuration, each call timed."""

    def run(targets: np.ndarray, near: np.ndarray, times: list) -> Iterable[np.ndarray]:
        for target, start in zip(targets, near, strict=True):
            target, start = prepared(target), np.ascontiguousarray(start)
            begin = perf_counter()
            found = solve(target, start)
            times.append(1e6 * (perf_counter() - begin))
            yield np.array([np.asarray(it, dtype=float) for it in found]).reshape(-1, len(start))

    return run


def without_home(arm: Arm) -> Callable:
    """Those whose tip is not turned at zero get the target turned back."""
    back = np.eye(4)
    back[:3, :3] = arm.home[:3, :3].T
    return lambda target: target @ back


def ssik_of(arm: Arm, nearest: bool) -> Solve | None:
    import ssik

    # Seven axes have no end of configurations.
    if not nearest and len(arm.directions) != 6:
        return None
    limits = np.tile([-np.pi, np.pi], (len(arm.directions), 1))
    solver = ssik.Manipulator.from_axes(arm.directions, arm.steps(), limits=limits)
    solver.prepare()
    more = {"max_solutions": 1} if nearest else {}

    def solve(target: np.ndarray, near: np.ndarray) -> list:
        seed = {"q_seed": near} if nearest else {}
        return [it.q for it in solver.solve(target, respect_limits=False, **seed, **more)]

    return one_by_one(solve, without_home(arm))


def eaik_of(arm: Arm) -> Solve | None:
    from eaik.IK_HP import HPRobot

    if len(arm.directions) != 6:
        return None
    solver = HPRobot(np.array(arm.directions), arm.steps())
    if not solver.hasKnownDecomposition():
        return None

    def solve(target: np.ndarray, _near: np.ndarray) -> list:
        found = solver.IK(target)
        return [q for q, is_least in zip(found.Q, found.is_LS, strict=True) if not is_least]

    return one_by_one(solve, without_home(arm))


def pinocchio_of(arm: Arm) -> Solve:
    """Closed-loop inverse kinematics, a step `q ← q − Jᵀ(JJᵀ + λ)⁻¹ e`, in Python around Pinocchio's functions."""
    import pinocchio as pin

    model, joint, before = pin.Model(), 0, np.zeros(3)
    for index, (w, p) in enumerate(zip(np.array(arm.directions), np.array(arm.points), strict=True)):
        kind = pin.JointModelRevoluteUnaligned(w)
        joint = model.addJoint(joint, kind, pin.SE3(np.eye(3), p - before), f"joint{index + 1}")
        before = p
    offset = pin.SE3(arm.home[:3, :3], arm.home[:3, 3] - before)
    tool = model.addFrame(pin.Frame("tool", joint, 0, offset, pin.FrameType.OP_FRAME))
    data = model.createData()

    def solve(target: np.ndarray, near: np.ndarray) -> list:
        q, goal = near.copy(), pin.SE3(target)
        for _ in range(STEPS):
            pin.forwardKinematics(model, data, q)
            apart = pin.updateFramePlacement(model, data, tool).actInv(goal)
            error = pin.log6(apart).vector
            if np.linalg.norm(error) < END:
                break
            jacobian = -pin.Jlog6(apart.inverse()) @ pin.computeFrameJacobian(model, data, q, tool)
            q -= jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + DAMPING * np.eye(6), error)
        return [q]

    return one_by_one(solve)


@cache
def poecal_alone() -> ModuleType:
    """The package, with one thread."""
    import poecal

    poecal.set_threads(1)
    return poecal


def poecal_of(arm: Arm, nearest: bool) -> Solve | None:
    """Of a calibration of this arm from poses without noise, all targets in one call, by one thread."""
    poecal = poecal_alone()
    if not nearest and len(arm.directions) != 6:
        return None
    screws = [[*np.cross(p, w), *w] for w, p in zip(arm.directions, arm.points, strict=True)]
    robot = poecal.Robot.from_screws(screws, arm.home)
    none = {name: 0.0 for name in ("error_position_mm", "error_rotation_deg", "noise_position_mm", "noise_rotation_deg")}
    made = poecal.simulate(robot, count=60, device_frame="base", **none)
    calibration = poecal.calibrate(robot, made.measurements, corrections="off", device_frame="base", fix=["joints"])

    def run(targets: np.ndarray, near: np.ndarray, times: list) -> Iterable[np.ndarray]:
        start = {"near": near} if nearest else {}
        begin = perf_counter()
        found = calibration.ik(targets, limits=False, **start)
        times.append(1e6 * (perf_counter() - begin) / len(targets))
        return [it.reshape(-1, len(arm.directions)) for it in found]

    return run


ALL = {
    "poecal in Python": lambda arm: poecal_of(arm, nearest=False),
    "ssik": lambda arm: ssik_of(arm, nearest=False),
    "EAIK": eaik_of,
}
NEAREST = {
    "poecal in Python": lambda arm: poecal_of(arm, nearest=True),
    "Pinocchio, loop in Python": pinocchio_of,
    "ssik": lambda arm: ssik_of(arm, nearest=True),
}
