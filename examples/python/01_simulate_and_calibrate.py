"""An elbow with known errors, calibrated from poses.

A device at an unknown place measures the pose of the tool of a six-axis arm in m = 50 random configurations. The
arm differs from nominal: every axis, and the tool, is turned by 1° and shifted by 2 mm.

========= ==================================== ===============
symbol    what                                 known
========= ==================================== ===============
θ_k       joint values of row k, radians       read
ξ_1 … ξ_6 screws of the joints, base frame     nominal; fitted
M         pose of the tool in the base at zero nominal; fitted
D         pose of the base in the device       fitted
Y_k       pose of the tool in the device       measured
========= ==================================== ===============

State: 4 unknowns an axis, 6 of the tool; D has 6 more, which the screws absorb (docs/theory.md §8): 30 in all.
Measurement equation: Y_k = D exp(ξ_1 θ_1k) … exp(ξ_6 θ_6k) M, and noise.
Noise: white, 0.05 mm in each component of position and 0.01° in each of rotation. It is not given to the fit.

Its twin in Rust prints the same: crates/poecal/examples/01_simulate_and_calibrate.rs.
"""

from pathlib import Path

import poecal

ELBOW = Path(__file__).parents[1] / "elbow/robot.urdf"

robot = poecal.Robot.read(ELBOW)
made = poecal.simulate(robot, kind="pose", count=50, seed=1)

calibration = poecal.calibrate(made.nominal, made.measurements)
held_out = calibration.accuracy.held_out
assert held_out is not None
print(f"{calibration.accuracy.training.count} poses fitted, {held_out.count} held out")
for name, model in [("nominal", held_out.nominal), ("registered", held_out.registered), ("calibrated", held_out.calibrated)]:
    assert model.rotation_deg is not None
    print(f"{name:<12} {model.position_mm.rms:8.4f} mm {model.rotation_deg.rms:8.4f} deg (RMS)")
noise_mm = calibration.to_dict()["noise"]["sigma"]["position_mm"]
print(f"noise        {noise_mm:8.4f} mm each component, as the fit estimates it")
print(f"verdict      {calibration.verdict.level}")
for found in calibration.corrections:
    print(f"{found['joint']:<12} {found['change']['words']}")
