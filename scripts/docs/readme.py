"""Writes what the README's first command prints into the block below it.

    python3 scripts/docs/readme.py target/release/poecal
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COMMAND = re.compile(r"```sh\ncargo run --release -- (.*)\n```")
OUTPUT = re.compile(r"```text\n.*?```", re.DOTALL)


def main() -> None:
    program = Path(sys.argv[1]).resolve()
    readme = ROOT / "README.md"
    text = readme.read_text(encoding="utf-8")
    words = COMMAND.search(text)[1].split()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "poecal-out"
        run = subprocess.run([program, *words, "--out", out], cwd=ROOT, capture_output=True, text=True, check=True)
    printed = run.stdout.replace(str(out), "poecal-out")
    readme.write_text(OUTPUT.sub(lambda _: f"```text\n{printed}```", text, count=1), encoding="utf-8")


if __name__ == "__main__":
    main()
