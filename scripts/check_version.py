"""Checks that one version is named everywhere before it is published.

    python scripts/check_version.py         as it stands, in Cargo.toml and those of the crates, CHANGELOG.md, CITATION.cff and the npm package
    python scripts/check_version.py v1.2.3  for a release: that tag, and a day in the changelog
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Crates that users name themselves.
FOR_USERS = {"poecal", "poecal-arm", "poecal-detect", "poecal-lou2009"}


def one(pattern, name):
    """The match of a pattern in a file of the repository, with the line."""
    text = (ROOT / name).read_text(encoding="utf-8")
    match = re.search(pattern, text, re.M)
    if not match:
        raise SystemExit(f"{name}: found no version, expected a line like `{pattern}`")
    return match


def complaints(tag=None):
    """A sentence for each place that names another version than Cargo.toml."""
    version = one(r'^version = "([^"]+)"', "Cargo.toml")[1]
    for path in [ROOT / "Cargo.toml", *sorted(ROOT.glob("crates/*/Cargo.toml"))]:
        name = path.relative_to(ROOT).as_posix()
        for crate, found in re.findall(r'^(poecal[\w-]*) = \{ path = "[^"]+", version = "([^"]+)"', path.read_text(encoding="utf-8"), re.M):
            # Parts of the library change without notice: each fits its own version alone.
            expected = version if crate in FOR_USERS else f"={version}"
            if found != expected:
                yield f"{name}: found {crate} {found} among the dependencies, expected {expected}"
    changes = one(r"^## \[([^\]]+)\] - (\S+)", "CHANGELOG.md")
    if changes[1] != version:
        yield f"CHANGELOG.md: found {changes[1]} first, expected {version}"
    cited = one(r"^version: (\S+)", "CITATION.cff")[1].strip('"')
    if cited != version:
        yield f"CITATION.cff: found {cited}, expected {version}"
    npm = one(r'^  "version": "([^"]+)"', "web/npm/package.json")[1]
    if npm != version:
        yield f"web/npm/package.json: found {npm}, expected {version}"
    if tag is not None:
        if tag != f"v{version}":
            yield f"the tag: found {tag}, expected v{version}"
        if not re.fullmatch(r"\d{4}-\d{2}-\d{2}", changes[2]):
            yield f"CHANGELOG.md: found {version} of {changes[2]}, expected the day of the release, like 2026-01-31"


if __name__ == "__main__":
    found = list(complaints(*sys.argv[1:2]))
    print("\n".join(found) or "version: named alike everywhere")
    sys.exit(1 if found else 0)
