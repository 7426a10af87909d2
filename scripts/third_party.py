"""Writes THIRD-PARTY.txt: the licences of the contents of the program and the Python package, which their packages must carry.

    python scripts/third_party.py           writes it
    python scripts/third_party.py --check   says whether it is as it would be written

Of a crate that may be taken under the MIT licence, that is the text; of others, all texts that it brings. Needs the crates' sources
(`cargo fetch`), no network.
"""

import json
import re
import sys
from pathlib import Path

from check_dependencies import ROOT, cargo, in_tree, is_allowed

OUT = ROOT / "THIRD-PARTY.txt"
PROGRAMS = ("poecal-cli", "poecal-py")
TEXTS = re.compile(r"(?i)^(licen[cs]e|copying|notice|unlicense)")
FOLDER = ".licenses/*"
MIT = "Permission is hereby granted, free of charge"
# Components of every build beside crates, and those of static builds.
TOOLCHAIN = """\
The standard library of Rust, from https://github.com/rust-lang/rust, under the MIT licence (below) or the Apache License 2.0, at your
choice; parts of it under other permissive licences, which its distribution names.

Programs for targets *-linux-musl, such as the archives of a release, contain the C library musl, https://musl.libc.org, under the MIT
licence: Copyright (c) 2005-2020 Rich Felker, et al. Programs that scripts/static-program builds for targets *-linux-gnu, among them the
one of the container image, contain the GNU C library, https://www.gnu.org/software/libc, under the GNU Lesser General Public License,
version 2.1 or later; who hands such a program on must let it be linked with another version of that library, as the sources of poecal do.
"""
HEAD = """\
Software of others in poecal's program and Python package, each part under its own licence. The scripts that reports contain carry
theirs with them. Written by scripts/third_party.py.
"""


def shipped():
    """The packages whose code is in the shipped files: no macros, and nothing that only builds or tests need."""
    programs = [word for name in PROGRAMS for word in ("--package", name)]
    tree = in_tree(*programs, "--edges", "normal,no-proc-macro")
    packages = json.loads(cargo("metadata", "--locked", "--format-version", "1"))["packages"]
    found = [it for it in packages if it["source"] and (it["name"], f"v{it['version']}") in tree]
    return sorted(found, key=lambda package: (package["name"], package["version"]))


def texts(package):
    """The texts of a package's licence. If a folder of its own holds them, the text beside it states whose they are and is kept."""
    folder = Path(package["manifest_path"]).parent
    beside = [path for path in sorted(folder.iterdir()) if path.is_file() and TEXTS.match(path.name)]
    within = [path for path in sorted(folder.glob(FOLDER)) if path.is_file()]
    found = [path.read_text(encoding="utf-8").strip() for path in beside + within]
    if is_allowed(package["license"], {"MIT"}):
        whose = found[: len(beside)] if within else []
        found = whose + [text for text in found if MIT in text and text not in whose] or found
    return ["\n".join(line.rstrip() for line in text.splitlines()) for text in found]


def standard(package):
    """The MIT licence in its standard words, for a package that names it and brings no text."""
    if not is_allowed(package["license"], {"MIT"}):
        raise SystemExit(f"{package['name']}: found no text of the licence {package['license']} in its package")
    holders = ", ".join(re.sub(r" *<.*?>", "", author) for author in package["authors"]) or f"the authors of {package['name']}"
    text = (ROOT / "LICENSE-MIT").read_text(encoding="utf-8")
    return re.sub(r"Copyright .*", f"Copyright (c) {holders}", text, count=1).strip()


def written():
    """The whole text: packages with the same licence together."""
    of_text = {}
    for package in shipped():
        for text in texts(package) or [standard(package)]:
            of_text.setdefault(text, []).append(package)
    mit = (ROOT / "LICENSE-MIT").read_text(encoding="utf-8").split("\n\n", 2)[2].strip()
    parts = [HEAD, f"{'=' * 80}\n{TOOLCHAIN}{'-' * 80}\n\n{mit}\n"]
    for text, packages in of_text.items():
        names = [f"{it['name']} {it['version']} ({it['license']})" for it in packages]
        parts.append(f"{'=' * 80}\n" + "\n".join(names) + f"\n{'-' * 80}\n\n{text}\n")
    return "\n".join(parts)


def main():
    text = written()
    if "--check" not in sys.argv:
        OUT.write_text(text, encoding="utf-8")
        return 0
    same = OUT.exists() and OUT.read_text(encoding="utf-8") == text
    print("THIRD-PARTY.txt: is as written" if same else "THIRD-PARTY.txt: is not of Cargo.lock; write it: python3 scripts/third_party.py")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
