"""Checks that requirements-test.lock is of requirements-test.txt: every package that is listed is locked within its range, with checksums,
and nothing is locked as listed that is not. Without network; to write the lock anew:

    uv pip compile --universal --generate-hashes --python-version 3.10 requirements-test.txt -o requirements-test.lock
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OPERATORS = {
    ">=": lambda found, stated: found >= stated,
    "<": lambda found, stated: found < stated,
    "==": lambda found, stated: found == stated,
}


def listed(text):
    """The ranges of each package that is listed: {name: [(operator, version)]}."""
    found = {}
    for line in text.splitlines():
        line = line.split("#")[0].strip()
        if not line:
            continue
        # Extras select further packages, which are locked by their own names.
        name, ranges = re.fullmatch(r"([A-Za-z0-9._-]+)(?:\[[a-z,]+\])?((?:>=|<|==).+)", line).groups()
        ranges = [re.fullmatch(r"(>=|<|==)([0-9.]+)", part.strip()).groups() for part in ranges.split(",")]
        found[normal(name)] = ranges
    return found


def locked(text):
    """The locked packages: [(name, version, number of checksums, packages that require it)]."""
    found = []
    for block in re.split(r"\n(?=[A-Za-z0-9])", "\n" + text):
        entry = re.match(r"\s*([A-Za-z0-9._-]+)==(\S+)", block)
        if entry:
            found.append((normal(entry[1]), entry[2], block.count("--hash=sha256:"), block))
    return found


def normal(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def number(version):
    """Comparable, without the part after the release's numbers."""
    parts = [int(part) for part in re.match(r"\d+(?:\.\d+)*", version)[0].split(".")]
    while parts and parts[-1] == 0:
        parts.pop()
    return parts


def complaints(listed_text, locked_text):
    """A sentence for each package that does not fit."""
    ranges, entries = listed(listed_text), locked(locked_text)
    for name in sorted(ranges.keys() - {name for name, *_ in entries}):
        yield f"{name}: is listed and not locked"
    for name, version, checksums, block in entries:
        if not checksums:
            yield f"{name} {version}: is locked without checksums"
        for operator, stated in ranges.get(name, []):
            if not OPERATORS[operator](number(version), number(stated)):
                yield f"{name} {version}: is locked, but {operator}{stated} is listed"
        if "-r requirements-test.txt" in block and name not in ranges:
            yield f"{name} {version}: is locked as listed, but is not listed"


def main():
    read = lambda name: (ROOT / name).read_text(encoding="utf-8")  # noqa: E731
    found = list(complaints(read("requirements-test.txt"), read("requirements-test.lock")))
    for complaint in found:
        print(f"{complaint}; write requirements-test.lock anew (scripts/check_python_lock.py says how)")
    if not found:
        print(f"requirements-test.lock: {len(locked(read('requirements-test.lock')))} packages, as requirements-test.txt asks")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
