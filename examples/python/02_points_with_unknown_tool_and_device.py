"""A laser tracker at an unknown place, and a reflector at an unknown place on the tool.

The tracker measures positions alone, of one reflector, in m = 100 configurations. Its place, and that of the
reflector on the tool, are unknown.

========= ======================================== =====================
symbol    what                                     known
========= ======================================== =====================
θ_k       joint values of row k, radians           read
ξ_1 … ξ_6 screws of the joints, base frame         nominal; fitted
p         the reflector in the base at zero        rough nominal; fitted
D         pose of the base in the tracker          fitted
y_k       position of the reflector in the tracker measured
========= ======================================== =====================

State: 4 unknowns an axis and 3 of the reflector; D has 6 more, which the screws absorb (docs/theory.md §8): 27 in all.
Measurement equation: y_k = D exp(ξ_1 θ_1k) … exp(ξ_6 θ_6k) p, and noise.
Noise: white, 0.05 mm in each component. It is not given to the fit.

The rows are those of examples/elbow/points.csv. Its twin in Rust prints the same:
crates/poecal/examples/02_points_with_unknown_tool_and_device.rs.
"""

from pathlib import Path

import poecal

ELBOW = Path(__file__).parents[1] / "elbow"

robot = poecal.Robot.read(ELBOW / "robot.urdf")
measured = poecal.Measurements.from_csv(ELBOW / "points.csv", robot)
calibration = poecal.calibrate(robot, measured)

x, y, z = 1e3 * calibration.base_from_device[:3, 3]
print(f"the tracker stands at ({x:.3f}, {y:.3f}, {z:.3f}) mm in the base")
x, y, z = 1e3 * calibration.robot.home[:3, 3]
a, b, c = 1e3 * robot.home[:3, 3]
print(f"the reflector is at ({x:.3f}, {y:.3f}, {z:.3f}) mm at zero, nominal ({a:.3f}, {b:.3f}, {c:.3f}) mm")
held_out = calibration.accuracy.held_out
assert held_out is not None
for name, model in [("nominal", held_out.nominal), ("registered", held_out.registered), ("calibrated", held_out.calibrated)]:
    print(f"{name:<12} {model.position_mm.rms:8.4f} mm (RMS) on {held_out.count} points")
found = calibration.identifiability
print(f"determined   {found['rank']} of {found['parameters']} unknowns")
for direction in found["weak"]:
    print(f"weak         {direction['description']}")
