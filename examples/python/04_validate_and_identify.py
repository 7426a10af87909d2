"""Which configurations to measure, and a calibration judged by other rows.

Before anything is measured, identify shows which unknowns given configurations would determine. 8 and
40 are compared; the 40 are measured, every row is fitted, and the calibration is judged by 200 held-out rows.

====== ============================================================= ===============
symbol what                                                          known
====== ============================================================= ===============
θ_k    joint values of row k, radians                                chosen
x      screws of the axes and the point of the reflector, 27 numbers nominal; fitted
H_k    motion of the reflector of row k by x                         nominal
y_k    position of the reflector in the tracker                      measured
====== ============================================================= ===============

State: x; the tracker's place is unknown.
Measurement equation: y_k = D f(θ_k; x), and noise; of errors of x, δy_k = H_k δx.
Noise: white, σ = 0.05 mm in each component. Information: Σ H_kᵀ H_k / σ², of which rank and covariance follow.

Its twin in Rust prints the same: crates/poecal/examples/04_validate_and_identify.rs.
"""

from pathlib import Path

import poecal

ELBOW = Path(__file__).parents[1] / "elbow/robot.urdf"

nominal = poecal.Robot.read(ELBOW)
made = poecal.simulate(nominal, kind="point", count=40, seed=5, held_out_count=200)
others = made.held_out
assert others is not None

for count in [8, 40]:
    found = poecal.identify(nominal, made.measurements.joints[:count], kind="point")
    mean_mm = found["expected_error"]["position_mean_mm"]
    expected = "no prediction" if mean_mm is None else f"{mean_mm:.4f} mm expected error"
    print(f"{count} points would determine {found.determined} of {found.unknowns} unknowns: {expected}")

calibration = poecal.calibrate(nominal, made.measurements, held_out=0)
judgement = calibration.validate(others)
assert judgement.inside_bound95 is not None
print(f"{judgement.count} other points: error {judgement.position_rms_mm:.4f} mm (RMS), {judgement.position_max_mm:.4f} mm at most")
print(f"expected {judgement.expected_rms_mm:.4f} mm with noise; {100 * judgement.inside_bound95:.1f} % are inside their 95 % bounds")
