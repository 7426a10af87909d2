"""Cost of ``poecal.calibrate`` beyond the library's own call: ``python crates/poecal-py/benches/overhead.py [rows]``.

Each call is timed as a whole in Python, and inside it the library's call in Rust; their difference is the part of Python: arguments, conversions,
locks, the object that is returned, and its release. Both times are of the same call, so that the load of the machine does not blur the difference.
"""

import sys
import time

import numpy as np

import poecal

REPEATS = 200


def main() -> None:
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    # The elbow of six axes from which every robot of the documentation is made.
    robot = poecal.Robot.from_dh(
        a_m=[0.15, 0.57, 0.15, 0, 0, 0],
        alpha_rad=[-1.57, 0, -1.57, 1.57, -1.57, 0],
        d_m=[0, 0, 0, 0.634, 0, 0.05],
        theta_rad=[0, -1.5, 0, 0, 0, 0],
    )
    made = poecal.simulate(robot, count=rows)
    measurements = made.measurements
    joints, poses = measurements.joints, measurements.poses
    whole: list[float] = []
    library: list[float] = []
    arrays: list[float] = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        found = poecal.calibrate(robot, measurements)
        calibrated = time.perf_counter()
        inside = found.library_seconds or 0.0
        released = time.perf_counter()
        del found
        end = time.perf_counter()
        whole.append((calibrated - start) + (end - released))
        library.append(inside)
        start = time.perf_counter()
        poecal.Measurements.from_arrays(robot, joints=joints, poses=poses)
        arrays.append(time.perf_counter() - start)
    beyond = 1e3 * (np.array(whole) - library)
    print(f"{rows} poses, {REPEATS} calls of poecal.calibrate")
    print(f"library        {1e3 * np.median(library):8.4f} ms (median), {1e3 * np.min(library):.4f} (least)")
    print(f"beyond it      {np.median(beyond):8.4f} ms (median), {np.quantile(beyond, 0.95):.4f} (95 %)")
    print(f"from_arrays    {1e3 * np.median(arrays):8.4f} ms (median)")


if __name__ == "__main__":
    main()
