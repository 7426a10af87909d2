"""Packs the program for distribution: with licences, completions for shells and manual pages, in one archive, beside its checksum.

    python scripts/package.py PROGRAM TARGET FOLDER

PROGRAM must run on this machine, TARGET names the target machines (rustc's name). Writes poecal-VERSION-TARGET.tar.gz, or .zip for Windows, and the
same name with .sha256, into FOLDER.
"""

import hashlib
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from docs.commands import names

ROOT = Path(__file__).resolve().parents[1]
# The page of the program's crate: its links are valid from anywhere.
TEXTS = ["crates/poecal-cli/README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"]
# Shells, each with the file name that it searches.
SHELLS = {"bash": "poecal.bash", "elvish": "poecal.elv", "fish": "poecal.fish", "powershell": "poecal.ps1", "zsh": "_poecal"}


def said(program, *arguments):
    return subprocess.run([program, *arguments], stdout=subprocess.PIPE, check=True).stdout


def package(program, target, folder):
    """Writes the archive, and returns its path."""
    version = said(program, "--version").decode().split()[1]
    name = f"poecal-{version}-{target}"
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as parent:
        content = Path(parent) / name
        (content / "completions").mkdir(parents=True)
        (content / "man").mkdir()
        shutil.copy2(program, content / program.name)
        for text in TEXTS:
            shutil.copy2(ROOT / text, content)
        for shell, file in SHELLS.items():
            (content / "completions" / file).write_bytes(said(program, "completions", shell))
        (content / "man/poecal.1").write_bytes(said(program, "man"))
        for command in names(said(program, "--help").decode()):
            (content / f"man/poecal-{command}.1").write_bytes(said(program, "man", command))
        form = "zip" if "windows" in target else "gztar"
        archive = Path(shutil.make_archive(str(folder / name), form, root_dir=parent, base_dir=name))
    digest = hashlib.sha256(archive.read_bytes()).hexdigest()
    Path(f"{archive}.sha256").write_text(f"{digest}  {archive.name}\n", encoding="utf-8")
    return archive


if __name__ == "__main__":
    print(package(Path(sys.argv[1]).resolve(), sys.argv[2], Path(sys.argv[3])))
