"""The expected error of each prediction, against the true one.

A calibrated model predicts the pose of the tool, with its uncertainty. Here the truth is known: the predictions of 1,000 further
configurations are compared with it.

====== ========================================= =============================
symbol what                                      known
====== ========================================= =============================
θ_k    joint values, radians                     read
f(θ)   pose of the tool by the calibrated screws fitted
f*(θ)  pose of the tool of the actual robot      known to the simulation alone
C      covariance of all unknowns                fitted with them
J(θ)   motion of the tool by the unknowns        from the screws
====== ========================================= =============================

State: 30 unknowns, of six axes and the tool, from 35 poses of 50 (the others are held out); the device's place is unknown.
Measurement equation: Y_k = D f*(θ_k), and noise.
Noise: white, 0.05 mm and 0.01° in each component. Prediction: cov f(θ) = J(θ) C J(θ)ᵀ (docs/theory.md §9).

Its twin in Rust prints the same: crates/poecal/examples/03_predict_with_uncertainty.rs.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import poecal

ELBOW = Path(__file__).parents[1] / "elbow/robot.urdf"


def rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))


nominal = poecal.Robot.read(ELBOW)
made = poecal.simulate(nominal, kind="pose", count=50, seed=3, held_out_count=1000)
truth = made.held_out
assert truth is not None
calibration = poecal.calibrate(nominal, made.measurements)

found = calibration.predict(truth.joints, with_uncertainty=True, output_frame="device")
errors_mm = 1e3 * np.linalg.norm(found.poses[:, :3, 3] - truth.positions, axis=1)
expected_mm = 1e3 * found.sigma_position_m
print(f"expected     {rms(expected_mm):.4f} mm (RMS) in {len(found)} configurations")
print(f"true         {rms(errors_mm):.4f} mm (RMS)")
print(f"inside their 95 % bounds: {np.count_nonzero(errors_mm <= 1e3 * found.bound95_position_m)}")
print(f"inside the sampled range: {np.count_nonzero(found.inside_sampled_range)}")
for row in range(3):
    print(f"row {row}        expected {expected_mm[row]:.4f} mm, true {errors_mm[row]:.4f} mm")
