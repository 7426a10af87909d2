"""The programs that are compared: how to get each, and how it is run on a problem."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from problems import ROOT, SIGMA_POSITION, SIGMA_ROTATION, Problem

HERE = Path(__file__).resolve().parent
BUILD = ROOT / "target/peers"

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")
ONE_THREAD = {**os.environ, **dict.fromkeys(THREADS, "1")}

# Linux counts what a process was before `exec` to its peak memory. So a small interpreter starts the program, and not the runner.
LAUNCHER = """
import os, sys
child = os.fork()
if child == 0:
    os.execv(sys.argv[2], sys.argv[2:])
_, status, used = os.wait4(child, 0)
with open(sys.argv[1], "w") as out:
    out.write(str(used.ru_maxrss))
sys.exit(os.waitstatus_to_exitcode(status))
"""

MONTE_CARLO_FITS = 1000


class Failed(Exception):
    """A peer ended with an error."""


@dataclass(frozen=True)
class Peer:
    """`run` gives, of a problem and its folder, `cpu_ms`, `iterations`, `held_out_mm` and `rss_mb`."""

    name: str
    modes: tuple[str, ...]
    run: Callable[[Problem, Path], dict]
    most_rows: int = sys.maxsize
    most_joints: int = sys.maxsize

    def takes(self, problem: Problem) -> bool:
        return problem.mode in self.modes and problem.m <= self.most_rows and problem.n <= self.most_joints


def run(command: list) -> tuple[str, str, float]:
    """Standard output and standard error of a program, and its peak memory in MB."""
    words = [str(word) for word in command]
    with tempfile.TemporaryDirectory() as folder:
        memory = Path(folder) / "memory"
        launch = [sys.executable, "-I", "-S", "-c", LAUNCHER, str(memory), *words]
        done = subprocess.run(launch, capture_output=True, text=True, env=ONE_THREAD)
        if done.returncode != 0:
            raise Failed(f"`{' '.join(words)}` ended with code {done.returncode}:\n{done.stderr.strip()}")
        return done.stdout, done.stderr, int(memory.read_text()) / 1024


def printed(command: list, problem: Problem) -> dict:
    """What a peer prints, a line of JSON, with its memory. The time of Monte Carlo is that of a thousand fits."""
    out, _, rss_mb = run(command)
    result = json.loads(out)
    if problem.fits:
        result["cpu_ms"] *= MONTE_CARLO_FITS / problem.fits
    return {**result, "rss_mb": rss_mb}


def poecal_peer(poecal: Path) -> Peer:
    def calibrate(problem: Problem, folder: Path) -> dict:
        out = folder / "calibrated"
        known = ["--device-frame", "base", "--sigma-position", SIGMA_POSITION, "--sigma-rotation", SIGMA_ROTATION]
        plain = ["--held-out", "0", "--robust", "off", "--threads", "1", "--quiet", "--force", "--out", out, "--timings"]
        command = [poecal, "calibrate", problem.model, folder / "measurements.csv", *known, *plain]
        _, err, rss_mb = run(command)
        timings = json.loads(next(line for line in err.splitlines() if line.startswith("{")))
        judged = json.loads(run([poecal, "validate", out / "calibration.json", folder / "held_out.csv", "--json"])[0])
        return {
            "cpu_ms": timings["solve"]["cpu_ms"],
            "iterations": timings["solve"]["iterations"],
            "held_out_mm": judged["calibrated"]["position_mm"]["rms"],
            "rss_mb": rss_mb,
            "start_cpu_ms": timings["start"]["cpu_ms"],
        }

    return Peer("poecal", ("pose", "point"), calibrate)


def built_bench(name: str) -> tuple[str | None, str | None]:
    """A benchmark of the library that prints what the peers print, or why there is none."""
    command = ["cargo", "bench", "-p", "poecal", "--bench", name, "--no-run", "--message-format", "json"]
    try:
        built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    except OSError:
        return None, "found no cargo, which builds it"
    artifacts = [json.loads(line) for line in built.stdout.splitlines() if line.startswith("{")]
    programs = [one["executable"] for one in artifacts if one.get("executable") and one["target"]["name"] == name]
    return (programs[0], None) if programs else (None, f"cannot be built: {built.stderr.strip().splitlines()[-1]}")


def poecal_monte_carlo() -> tuple[list[Peer], str | None]:
    """The benchmark `monte_carlo`."""
    program, missing = built_bench("monte_carlo")
    if program is None:
        return [], f"poecal, Monte Carlo: {missing}"

    def repeat(problem: Problem, folder: Path) -> dict:
        return printed([program, problem.model, folder / "exact.csv", folder / "held_out.csv", problem.fits], problem)

    return [Peer("poecal", ("monte_carlo",), repeat)], None


def compiled(name: str) -> tuple[Path | None, str | None]:
    """A program with Ceres, or why there is none."""
    install = "apt-get install g++ libceres-dev libeigen3-dev"
    compiler = os.environ.get("CXX", "g++")
    if shutil.which(compiler) is None:
        return None, f"Ceres: found no {compiler}; {install}"
    BUILD.mkdir(parents=True, exist_ok=True)
    program = BUILD / name
    flags = ["-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-I/usr/include/eigen3"]
    command = [compiler, *flags, HERE / f"{name}.cpp", "-o", program, "-lceres", "-lglog"]
    built = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if built.returncode != 0:
        reason = next((line for line in built.stderr.splitlines() if "error" in line), "the compiler failed")
        return None, f"Ceres: {reason.strip()}; {install}"
    return program, None


def ceres_peers() -> tuple[list[Peer], str | None]:
    program, missing = compiled("ceres_peer")
    if program is None:
        return [], missing

    def peer(solver: str) -> Peer:
        def solve(problem: Problem, folder: Path) -> dict:
            fits = [problem.fits] if problem.fits else []
            return printed([program, folder, problem.mode, solver, *fits], problem)

        return Peer(f"ceres-{solver}", ("pose", "point", "monte_carlo"), solve)

    return [peer("cholesky"), peer("qr"), peer("tuned")], None


def python_peers(python: str) -> tuple[list[Peer], list[str]]:
    """SciPy and Pinocchio, as far as `python` has them."""

    def peer(name: str, script: str, *arguments: str, modes=("pose", "point"), **limits) -> Peer:
        def solve(problem: Problem, folder: Path) -> dict:
            return printed([python, HERE / script, folder, problem.mode, *arguments], problem)

        return Peer(name, modes, solve, **limits)

    found, missing = [], []
    if has(python, "scipy.optimize"):
        found.append(peer("scipy-analytic", "scipy_peer.py", "analytic"))
        # Beyond these a fit takes minutes.
        limits = {"most_rows": 5000, "most_joints": 6}
        found.append(peer("scipy-differences", "scipy_peer.py", "finite_differences", **limits))
    else:
        missing.append(f"SciPy: {python} has none; pip install numpy scipy, and name that Python by --python")
    if has(python, "pinocchio", "numpy"):
        found.append(peer("pinocchio", "pinocchio_peer.py", modes=("pose",)))
    else:
        missing.append(f"Pinocchio: {python} has none; pip install numpy pin, and name that Python by --python")
    return found, missing


def has(python: str, *modules: str) -> bool:
    probe = [python, "-c", f"import {', '.join(modules)}"]
    try:
        return subprocess.run(probe, capture_output=True).returncode == 0
    except OSError:
        return False
