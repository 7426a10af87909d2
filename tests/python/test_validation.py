"""Calibrations of real measured robots, where the data sets are at hand."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SKIPPED = 77


def test_real_robots_reach_their_figures():
    done = subprocess.run([sys.executable, ROOT / "validation" / "run", "--check"], capture_output=True, text=True)
    print(done.stdout, done.stderr)
    if done.returncode == SKIPPED:
        pytest.skip(done.stdout.strip())
    assert done.returncode == 0, done.stderr
