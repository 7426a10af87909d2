"""Kinematic calibration of serial robots by the product of exponentials.

The package states its version; robots, measurements and fits are not in it yet. Until they are, the program
``poecal`` does the work and writes ``calibration.json``, which any Python reads.

>>> import poecal
>>> poecal.version() == poecal.__version__
True
"""

from ._poecal import version

__all__ = ["__version__", "version"]

__version__: str = version()
