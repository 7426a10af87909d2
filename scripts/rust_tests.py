#!/usr/bin/env python3
"""Builds the Rust tests of the workspace, and runs each in a process of its own, as many at once as there are processors.

    scripts/rust_tests.py --build              builds the tests, the program and the examples that tests run
    scripts/rust_tests.py [--build] [WORD…]    runs the tests whose names contain one of these words, and none of the words with - before;
                                               without a word all

Each test has its own processor time, with the programs that it runs; the slowest are printed. `./test` calls it, with POECAL_PROFILE=tested; the
profile is `test` if that is not set.
Needs only Python 3.10 and cargo.
"""

import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

from steps import PROCESSORS, ROOT

# Without libtest, so without a list of tests: one test as a whole.
WHOLE = {"fuzz"}
SLOWEST = 10


def profile():
    return os.environ.get("POECAL_PROFILE", "test")


def target():
    """The folder of cargo's output."""
    return Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))


def build(options):
    """Builds tests; returns their programs as crate, name, path and folder, or None.

    `options` select packages and their targets, in the words of `cargo test`.
    """
    command = ["cargo", "test", "--locked", "--profile", profile(), "--no-run", "--message-format", "json-render-diagnostics"]
    done = subprocess.run([*command, *options], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        return None
    programs = []
    for line in done.stdout.splitlines():
        message = json.loads(line)
        if message["reason"] == "compiler-artifact" and message["executable"] and message["profile"]["test"]:
            folder = Path(message["manifest_path"]).parent
            programs.append((folder.name, message["target"]["name"], message["executable"], str(folder)))
    return programs


def build_examples():
    """Builds the examples that tests/python/test_examples.py runs, beside the program; returns whether that succeeded."""
    # With the packages of the workspace, as the tests: with others the features would differ, and everything would be compiled again.
    command = ["cargo", "build", "--locked", "--profile", profile(), "--workspace", "--examples"]
    return subprocess.run(command, cwd=ROOT, check=False).returncode == 0


def tests_of(program):
    """The tests of a program: its words for a person, the command, and the folder."""
    crate, name, executable, folder = program
    if name in WHOLE:
        return [(f"{crate} {name}", [executable], folder)]
    said = subprocess.run([executable, "--list", "--format", "terse"], cwd=folder, capture_output=True, text=True, check=True).stdout
    tests = [line.removesuffix(": test") for line in said.splitlines() if line.endswith(": test")]
    return [(f"{crate} {name} {test}", [executable, "--exact", test, "--nocapture"], folder) for test in tests]


def once(command, folder):
    """Runs a test; returns whether it passed, its seconds, which are those of processors if the system counts them, and its output."""
    start = time.monotonic()
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace") as process:
        said = process.stdout.read()
        if not hasattr(os, "wait4"):
            return process.wait() == 0, time.monotonic() - start, said
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode == 0, used.ru_utime + used.ru_stime, said


def run(tests):
    """Runs all, as many at once as there are processors; returns seconds, whether each passed, and its output, by name."""
    waiting, results, lock = list(reversed(tests)), {}, threading.Lock()

    def work():
        while True:
            with lock:
                if not waiting:
                    return
                name, command, folder = waiting.pop()
            start = time.monotonic()
            try:
                passed, seconds, said = once(command, folder)
            except OSError as error:
                passed, seconds, said = False, time.monotonic() - start, f"it could not be run: {error}"
            with lock:
                results[name] = (seconds, passed, said)
                if not passed:
                    print(f"\n--- FAILED {name}\n{said}", flush=True)

    threads = [threading.Thread(target=work) for _ in range(PROCESSORS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return results


def report(results, of="seconds of processors"):
    """Prints the slowest tests and those that failed; returns the number that failed."""
    slowest = sorted(results.items(), key=lambda item: -item[1][0])[:SLOWEST]
    if slowest:
        print(f"\nslowest tests ({of}, {PROCESSORS} at once, POECAL_TRIALS={os.environ.get('POECAL_TRIALS') or 'not set'})")
    for name, (seconds, *_) in slowest:
        print(f"{seconds:6.2f} s  {name}")
    bad = sorted(name for name, (_, passed, _) in results.items() if not passed)
    for name in bad:
        print(f"FAILED {name}")
    return len(bad)


def main():
    words = sys.argv[1:]
    # Cargo keeps the profile of tests with that of development.
    kept = target() / ("debug" if profile() == "test" else profile()) / "tests.json"
    if "--build" in words:
        programs = build(["--workspace", "--tests"])
        if programs is None or not build_examples():
            sys.exit(1)
        kept.write_text(json.dumps(programs))
        words.remove("--build")
        if not words:
            return
    if not kept.is_file():
        sys.exit(f"found no {kept}, expected what `scripts/rust_tests.py --build` writes")
    tests = [test for program in json.loads(kept.read_text()) for test in tests_of(program)]
    wanted, unwanted = [word for word in words if not word.startswith("-")], [word[1:] for word in words if word.startswith("-")]
    chosen = [test for test in tests if not wanted or any(word in test[0] for word in wanted)]
    chosen = [test for test in chosen if not any(word in test[0] for word in unwanted)]
    lost = [word for word in words if not any(word.removeprefix("-") in test[0] for test in tests)]
    if lost or not chosen:
        sys.exit(f"found no test with {' or '.join(lost or words)} in its name")
    results = run(chosen)
    assert len(results) == len(chosen), "a test has no result"
    # The output of a test is its measurements.
    for name in sorted(results):
        figures = [line for line in results[name][2].splitlines() if line and not line.startswith(("running ", "test result:", f"test {name.split()[-1]} ..."))]
        if results[name][1] and figures:
            print(f"\n--- {name}\n" + "\n".join(figures))
    bad = report(results)
    print(f"\n{len(results) - bad} passed, {bad} failed")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
