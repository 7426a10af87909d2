"""Pictures of a board and raw positions of an arm's motors, for `poecal calibrate` with LeRobot's calibration of motors.

    python record.py PORT MOTORS.json CAMERA FOLDER

Hold the arm, press Enter, and let go when it has locked: the picture is taken then. `q` and Enter end the session.
"""

import json
import sys
import time
from pathlib import Path

import cv2
from lerobot.motors import Motor, MotorNormMode
from lerobot.motors.feetech import FeetechMotorsBus

port, motors, camera, folder = sys.argv[1], json.loads(Path(sys.argv[2]).read_text()), int(sys.argv[3]), Path(sys.argv[4])
bus = FeetechMotorsBus(port, {name: Motor(it["id"], "sts3215", MotorNormMode.DEGREES) for name, it in motors.items()})
bus.connect()
pictures = cv2.VideoCapture(camera)
folder.mkdir(parents=True)
with (folder / "motors.csv").open("w") as file:
    print("image", *(f"{name}[ticks]" for name in motors), sep=",", file=file, flush=True)
    count = 0
    while True:
        bus.disable_torque()
        if input(f"picture {count + 1}: ") == "q":
            break
        bus.enable_torque()
        time.sleep(1.0)
        for _ in range(5):  # Older pictures wait in the camera's buffer.
            taken, picture = pictures.read()
        ticks = bus.sync_read("Present_Position", normalize=False)
        if not taken:
            sys.exit("found no picture, expected one of the camera")
        count += 1
        name = f"{count:03}.png"
        cv2.imwrite(str(folder / name), picture)
        print(name, *(ticks[it] for it in motors), sep=",", file=file, flush=True)
bus.disconnect()
