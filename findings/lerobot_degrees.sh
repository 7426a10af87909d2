#!/usr/bin/env bash
# Degrees of a joint, as LeRobot reads them from a motor and sends them to it.
#
# Expected: a motor of 4096 ticks a turn reads 90 degrees after 1024 ticks; the nearest tick is sent;
# `drive_mode` 1 turns the sign around, as it does for values from -100 to 100.
# What happens: a turn counts 4095 ticks, so that 1024 ticks are 90.022 degrees, and 180 degrees are off by
# 0.044. What is sent is cut off rather than rounded: the motor stands below what was asked for by up to a
# tick, 0.088 degrees, and by half a tick on average, always on the same side. `drive_mode` does nothing,
# without a word: two calibrations of mirrored motors read alike.
# Whom it hurts: whoever measures an SO-100, SO-101 or Koch arm: half a tick of one joint is 0.3 mm at 0.4 m,
# always to one side, which a calibration takes for an offset of that joint if the values that were sent
# stand for those that were read. Read positions back after a motion.
# poecal: writes offsets of motors in whole ticks of 360/4096 degrees, rounded to the nearest
# (`poecal export --format lerobot`), and refuses a `drive_mode` other than 0.
# LeRobot wants Python 3.12. Torch, which its import asks for, is replaced by an empty module; no motor is
# needed.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python=python3
python3 -c 'import sys; sys.exit(sys.version_info < (3, 12))' || python=python3.12
$python -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check --no-deps lerobot==0.6.1
"$here/venv/bin/pip" install -q --disable-pip-version-check --no-warn-conflicts feetech-servo-sdk==1.0.0 \
  pyserial==3.5 numpy==2.2.6 deepdiff==8.6.1 tqdm==4.67.1 draccus==0.11.6 huggingface_hub==1.6.0 packaging==25.0
"$here/venv/bin/python" - <<'PY'
import statistics
import sys
import types
from importlib.metadata import version

torch = sys.modules["torch"] = types.ModuleType("torch")
torch.Tensor = torch.device = torch.dtype = object
from lerobot.motors import Motor, MotorCalibration, MotorNormMode
from lerobot.motors.feetech import FeetechMotorsBus

print("LeRobot", version("lerobot"))


def motor(mode, drive_mode=0, lowest=824, highest=3322):
    calibration = MotorCalibration(id=1, drive_mode=drive_mode, homing_offset=0, range_min=lowest, range_max=highest)
    bus = FeetechMotorsBus("no port", {"joint": Motor(1, "sts3215", mode)}, calibration={"joint": calibration})
    return lambda ticks: bus._normalize({1: ticks})[1], lambda value: bus._unnormalize({1: value})[1]


read, send = motor(MotorNormMode.DEGREES)
middle = (824 + 3322) // 2
quarter = read(middle + 1024) - read(middle)
print(f"1024 of 4096 ticks: {quarter:.4f} degrees")
asked = [step / 100 for step in range(-9000, 9001)]
misses = [read(send(value)) - value for value in asked]
print(f"sent and read back: off by {min(misses):.4f} to {max(misses):.4f} degrees, {statistics.mean(misses):.4f} on average")
unchanged = abs(quarter - 360 * 1024 / 4095) < 1e-9
unchanged = unchanged and -0.0880 < min(misses) < -0.0870 and max(misses) < 1e-9 and abs(statistics.mean(misses) + 0.044) < 0.001
for mode, turned in ((MotorNormMode.DEGREES, False), (MotorNormMode.RANGE_M100_100, True)):
    values = [motor(mode, drive_mode)[0](middle + 100) for drive_mode in (0, 1)]
    print(f"drive_mode 0 and 1, {mode.name:14}: {values[0]:.3f} and {values[1]:.3f}")
    unchanged = unchanged and abs(values[1] - (-values[0] if turned else values[0])) < 1e-9 and values[0] > 1
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
