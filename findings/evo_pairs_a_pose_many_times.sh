#!/usr/bin/env bash
# Two trajectories of one motion at different rates, associated by evo.
#
# Expected: associate_trajectories makes pairs: each pose of either trajectory is in one at most, as with
# TUM's associate.py, whose `max_diff` it has.
# What happens: the trajectory with fewer poses in all is gone through, and of the other the nearest pose is
# taken, again and again. One second at 200 Hz beside a reference of ten seconds at 50 Hz: each pose of the
# reference is in three or four pairs. Without any error, the relative error from pair to pair is as large
# as the motion. With a reference of one second, which has fewer poses then, the same trajectory has none.
# Nothing is said.
# Whom it hurts: whoever compares a fast controller or encoder with a slow tracker by relative errors, or
# weighs by the number of pairs. SyncMethod.interpolation repeats nothing where the reference is the longer.
# poecal: joins recordings by the stands in both, or in motion by interpolation at the times of the
# measurements, with the lag of the clocks as an unknown (`--join`).
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check evo==1.38.1 numpy==2.4.6
HOME=$here "$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from evo.core.metrics import RPE, PoseRelation, StatisticsType, Unit
from evo.core.sync import SyncMethod, associate_trajectories
from evo.core.trajectory import PoseTrajectory3D

print("evo", version("evo"))
SPEED = 0.5  # m/s, along x


def recorded(rate, seconds):
    times = np.arange(round(rate * seconds)) / rate
    places = np.stack([SPEED * times, 0 * times, 0 * times], axis=1)
    return PoseTrajectory3D(places, np.tile([1.0, 0.0, 0.0, 0.0], (len(times), 1)), times)


def compared(seconds, method):
    reference, fast = associate_trajectories(recorded(50, seconds), recorded(200, 1), max_diff=0.01, sync_method=method)
    error = RPE(PoseRelation.translation_part, delta=1, delta_unit=Unit.frames)
    error.process_data((reference, fast))
    pairs, apart = len(reference.timestamps), len(np.unique(reference.timestamps))
    step = 1000 * np.diff(fast.positions_xyz[:, 0]).mean()
    miss = 1000 * error.get_statistic(StatisticsType.rmse)
    print(
        f"  reference of {seconds:2} s, {method.value:13} {pairs:4} pairs with {apart:3} poses of the reference; "
        f"relative error {miss:.3f} mm, motion between pairs {step:.1f} mm"
    )
    return pairs, apart, miss, step


print("the same motion without errors at 50 Hz, and for 1 s at 200 Hz:")
pairs, apart, miss, step = compared(10, SyncMethod.nearest_time)
unchanged = pairs > 3 * apart and miss > step
pairs, apart, miss, _ = compared(1, SyncMethod.nearest_time)
unchanged = unchanged and pairs == apart and miss < 1e-9
pairs, apart, miss, _ = compared(10, SyncMethod.interpolation)
unchanged = unchanged and pairs == apart and miss < 1e-9
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
