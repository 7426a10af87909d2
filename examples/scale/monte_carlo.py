"""How far calibrations of one robot scatter, and whether the uncertainties that they state are true: 100,000 fits with new noise each.

    python monte_carlo.py --engine ray --trials 100000 --out monte-carlo

A robot with known errors is measured in the same configurations again and again. Each trial adds its own noise and calibrates as
`poecal.calibrate` does, with the noise stated, without held-out rows and without the corrected model. What it finds is compared with the truth:

- spread.csv: of each unknown of the axes, how far the fits are off (RMS), the standard deviation that they state (RMS), and the share that
  is off by less than 1.96 of these. The last row is the tip's position in other configurations, and the share within the stated 95 % bound;
- chunks.csv: the sums that this is computed from, a row for each chunk of trials.

The noise of a trial depends on its number alone, and sums are added in the order of the chunks: the files have the same bytes with every
engine and any number of processes.
"""

import argparse
import functools
import math
import warnings
from pathlib import Path
from typing import Any

import engines
import numpy as np
import poecal
from numpy.typing import NDArray

Array = NDArray[np.float64]

ELBOW = Path(__file__).parents[1] / "elbow/robot.urdf"
MOTIONS = ["x", "y", "rx", "ry"]
# Configurations in which the tip is compared.
OTHERS = 20


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path, nargs="?", default=ELBOW)
    parser.add_argument("--trials", type=engines.count, default=100_000)
    parser.add_argument("--chunk", type=engines.count, default=10_000, help="trials of a task (default 10,000)")
    parser.add_argument("--count", type=engines.count, default=20, help="poses that are measured in each trial (default 20)")
    parser.add_argument("--noise-mm", type=float, default=0.05)
    parser.add_argument("--noise-deg", type=float, default=0.01)
    parser.add_argument("--seed", type=engines.count, default=1)
    parser.add_argument("--out", type=Path, required=True, help="folder for the results")
    engines.add_options(parser)
    options = engines.options_of(parser)
    plan = {name: getattr(options, name) for name in ["trials", "chunk", "count", "noise_mm", "noise_deg", "seed"]}
    try:
        poecal.Robot.read(options.model)
    except poecal.Error as error:
        parser.error(str(error))
    # The text, so that other machines need no file.
    plan["model"] = options.model.read_text(encoding="utf-8")
    chunks = engines.run(functools.partial(fits, plan), range(0, options.trials, options.chunk), options)
    options.out.mkdir(parents=True, exist_ok=True)
    engines.write(options.out / "chunks.csv", chunks)
    rows = spread(chunks)
    engines.write(options.out / "spread.csv", rows)
    print(f"{sum(row['fits'] for row in chunks):,} fits of {options.count} poses, {sum(row['failed'] for row in chunks)} failed")
    print(f"{'':<16}{'off (RMS)':>12}{'stated':>12}      inside")
    for row in rows:
        print(f"{row['what']:<16}{row['off']:12.3e}{row['stated']:12.3e} {row['unit']:<4}{100 * row['inside']:7.2f} %")


def fits(plan: dict[str, Any], first: int) -> engines.Row:
    """The sums of a chunk of trials, whose numbers start at `first`."""
    warnings.simplefilter("ignore", poecal.PoecalWarning)
    nominal = poecal.Robot.from_text(plan["model"])
    exact = poecal.simulate(
        nominal, count=plan["count"], seed=plan["seed"], noise_position_mm=0, noise_rotation_deg=0, device_frame="base", held_out_count=OTHERS
    )
    others = exact.held_out
    assert others is not None
    joints, poses, other_joints = exact.measurements.joints, exact.measurements.poses, others.joints
    found, failed = [], None
    for trial in range(first, min(first + plan["chunk"], plan["trials"])):
        measured = disturbed(poses, plan, np.random.default_rng([plan["seed"], trial]))
        try:
            calibration = poecal.calibrate(
                nominal,
                poecal.Measurements.from_arrays(nominal, joints=joints, poses=measured),
                device_frame="base",
                sigma_position_mm=plan["noise_mm"],
                sigma_rotation_deg=plan["noise_deg"],
                corrections="off",
                held_out=0,
                move_tip=True,
            )
            covariance, tip = calibration.covariance, calibration.predict(other_joints, with_uncertainty=True)
        except poecal.Error as error:
            failed = error
            continue
        found.append((covariance.axes, covariance.sigma, tip.poses[:, :3, 3], tip.sigma_position_m, tip.bound95_position_m))
    if failed is not None and not found:
        raise failed
    axes, sigmas, tips, tip_sigmas, bounds = (np.array(column) for column in zip(*found, strict=True))
    row: engines.Row = {"first": first, "fits": len(found), "failed": trial + 1 - first - len(found)}
    off = deviations(axes, exact.actual.screws)
    for index, name in enumerate(covariance.names):
        joint, is_axis, motion = name.rpartition(".axis.")
        if is_axis:
            one = off[:, nominal.joint_names.index(joint), MOTIONS.index(motion)]
            row |= sums(name, one, sigmas[:, index], 1.96 * sigmas[:, index])
    return row | sums("tip", np.linalg.norm(tips - others.positions, axis=-1), tip_sigmas, bounds)


def disturbed(poses: Array, plan: dict[str, Any], generator: np.random.Generator) -> Array:
    """Poses with noise of their own: of each component of the position, and of each component of a small turn in the target's axes."""
    measured = poses.copy()
    measured[:, :3, 3] += 1e-3 * plan["noise_mm"] * generator.standard_normal((len(poses), 3))
    turn = np.radians(plan["noise_deg"]) * generator.standard_normal((len(poses), 3))
    angle = np.linalg.norm(turn, axis=1)[:, None, None]
    cross = np.cross(np.eye(3), turn[:, None, :])
    # Rodrigues' formula; sinc(x) is sin(πx)/(πx), so that no angle is divided by.
    rotation = np.eye(3) + np.sinc(angle / np.pi) * cross + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * (cross @ cross)
    measured[:, :3, :3] = poses[:, :3, :3] @ rotation
    return measured


def deviations(axes: Array, screws: Array) -> Array:
    """How far the actual axes are from the fitted ones, in the frames of these: shifts x and y, turns rx and ry, of (trials, joints)."""
    along, about = screws[:, :3], screws[:, 3:]
    # The actual screw's motion of the fitted frame's origin, and its turn, in the fitted frame.
    moved = ((along + np.cross(about, axes[..., :3, 3]))[..., None] * axes[..., :3, :3]).sum(-2)
    turned = (about[:, :, None] * axes[..., :3, :3]).sum(-2)
    slides = (about == 0).all(axis=1)[:, None]
    axis = np.where(slides, moved, turned)
    return np.stack([-moved[..., 1], moved[..., 0], -axis[..., 1], axis[..., 0]], axis=-1)


def sums(name: str, off: Array, sigma: Array, bound: Array) -> engines.Row:
    """What is added up of an unknown."""
    squares = {f"{name} off2": float((off**2).sum()), f"{name} stated2": float((sigma**2).sum())}
    return squares | {f"{name} count": off.size, f"{name} inside": int((abs(off) <= bound).sum())}


def spread(chunks: list[engines.Row]) -> list[engines.Row]:
    """The result: of each unknown and of the tip a row."""
    rows = []
    for name in [key.removesuffix(" count") for key in chunks[0] if key.endswith(" count")]:
        off2, stated2, count, inside = (sum(row[f"{name} {what}"] for row in chunks) for what in ["off2", "stated2", "count", "inside"])
        unit = "rad" if name.endswith(("rx", "ry")) else "m"
        rows.append({"what": name, "unit": unit, "off": math.sqrt(off2 / count), "stated": math.sqrt(stated2 / count), "inside": inside / count})
    return rows


if __name__ == "__main__":
    main()
