"""The same as compensate.c, from Python by ctypes alone.

python compensate.py LIBRARY ARMS.h READING...
"""

import ctypes
import re
import sys

library, header, *meant = sys.argv[1:]
poecal = ctypes.CDLL(library)


class Corrected(ctypes.Structure):
    _fields_ = [("position_m", ctypes.c_double), ("rotation_rad", ctypes.c_double), ("outcome", ctypes.c_int32)]


poecal.poecal_arm_new.restype = ctypes.c_void_p
poecal.poecal_arm_new.argtypes = [ctypes.POINTER(ctypes.c_double), ctypes.c_size_t]
poecal.poecal_arm_free.argtypes = [ctypes.c_void_p]
poecal.poecal_corrections_new.restype = ctypes.c_void_p
poecal.poecal_corrections_new.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_double, ctypes.c_double]
poecal.poecal_corrections_free.argtypes = [ctypes.c_void_p]
poecal.poecal_compensate.restype = Corrected
poecal.poecal_compensate.argtypes = [ctypes.c_void_p] + 2 * [ctypes.POINTER(ctypes.c_double)]


def arm(name: str) -> int:
    """The arm of an array of the header."""
    text = open(header).read()
    body = re.search(rf"poecal_{name}\[\d+\] = {{(.*?)}};", text, re.S).group(1)
    numbers = [float(it) for it in body.split(",") if it.strip()]
    return poecal.poecal_arm_new((ctypes.c_double * len(numbers))(*numbers), len(numbers))


nominal, actual = arm("nominal"), arm("actual")
q = (ctypes.c_double * len(meant))(*map(float, meant))
# No joint moves by more than 2 degrees, or 2 mm, beyond its zero.
corrections = poecal.poecal_corrections_new(nominal, actual, 0.0349, 0.002)
found = poecal.poecal_compensate(corrections, q, q)
print(*(f"{it:.15g}" for it in q), sep="\n")
poecal.poecal_corrections_free(corrections)
poecal.poecal_arm_free(actual)
poecal.poecal_arm_free(nominal)
# 0: reached; 1: its point is, near a singularity.
sys.exit(0 if found.outcome in (0, 1) else 1)
