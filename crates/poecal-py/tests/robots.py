"""Robots and measurements that the tests use."""

import numpy as np

import poecal

# An elbow of six axes, lengths in metres.
ALPHA = [-np.pi / 2, 0, -np.pi / 2, np.pi / 2, -np.pi / 2, 0]
ELBOW = {"a_m": [0.15, 0.57, 0.15, 0, 0, 0], "alpha_rad": ALPHA, "d_m": [0, 0, 0, 0.634, 0, 0.05], "theta_rad": [0, -1.5, 0, 0, 0, 0]}


def elbow() -> poecal.Robot:
    return poecal.Robot.from_dh(**ELBOW, limits=np.tile([-2.8, 2.8], (6, 1)), name="elbow")


def session(kind: str = "pose", **options) -> poecal.Simulation:
    return poecal.simulate(elbow(), kind=kind, **options)


def configurations(count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-2, 2, (count, 6))
