"""The same as compensate.c, from Python by ctypes alone.

python compensate.py LIBRARY ARMS.h READING...
"""

import ctypes
import re
import sys

library, header, *meant = sys.argv[1:]
poecal = ctypes.CDLL(library)


class Left(ctypes.Structure):
    _fields_ = [("position_m", ctypes.c_double), ("rotation_rad", ctypes.c_double)]


poecal.poecal_arm_new.restype = ctypes.c_void_p
poecal.poecal_arm_new.argtypes = [ctypes.POINTER(ctypes.c_double), ctypes.c_size_t]
poecal.poecal_arm_free.argtypes = [ctypes.c_void_p]
poecal.poecal_compensate.restype = Left
poecal.poecal_compensate.argtypes = [ctypes.c_void_p, ctypes.c_void_p] + 2 * [ctypes.POINTER(ctypes.c_double)]


def arm(name: str) -> int:
    """The arm of an array of the header."""
    text = open(header).read()
    body = re.search(rf"poecal_{name}\[\d+\] = {{(.*?)}};", text, re.S).group(1)
    numbers = [float(it) for it in body.split(",") if it.strip()]
    return poecal.poecal_arm_new((ctypes.c_double * len(numbers))(*numbers), len(numbers))


nominal, actual = arm("nominal"), arm("actual")
q = (ctypes.c_double * len(meant))(*map(float, meant))
left = poecal.poecal_compensate(nominal, actual, q, q)
print(*(f"{it:.15g}" for it in q), sep="\n")
poecal.poecal_arm_free(actual)
poecal.poecal_arm_free(nominal)
sys.exit(0 if left.position_m < 1e-9 and left.rotation_rad < 1e-9 else 1)
