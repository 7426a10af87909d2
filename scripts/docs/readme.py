"""Writes into the README the output of its first command, and the table of real robots; with --picture, its picture of the report too.

    python3 scripts/docs/readme.py target/release/poecal [--picture]

The picture needs Node.js, Chromium and the packages of web/, which ./test installs.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COMMAND = re.compile(r"```sh\ncargo run --release -- (.*)\n```")
OUTPUT = re.compile(r"```text\n.*?```", re.DOTALL)
TABLE = re.compile(r"(\| robot \| rows fitted.*\n\|[-|]+\n)((?:\|.*\n)*)")
RESULT = re.compile(
    r"\| (?P<robot>[^|]+) \| (?P<rows>\d+ / \d+) \| (?P<registered>[\d.]+)[^|]* \| (?P<calibrated>[\d.]+)[^|]* \| \*\*(?P<corrected>[\d.]+)\*\*"
)


def real_robots(results: str) -> str:
    """The rows of the README's table, from the text of validation/RESULTS.md."""
    # The first table: others have no mean position errors.
    rows = (RESULT.match(line) for line in results.split("\n## ")[0].splitlines())
    return "".join(
        f"| {row['robot']} | {row['rows']} | {row['registered']} | {row['calibrated']} | **{row['corrected']}** |\n"
        for row in rows
        if row and not row["robot"].startswith("the same")
    )


def with_real_robots(readme: str) -> str:
    """The README with its table of real robots as validation/RESULTS.md has it."""
    rows = real_robots((ROOT / "validation" / "RESULTS.md").read_text(encoding="utf-8"))
    return TABLE.sub(lambda found: found[1] + rows, readme)


def main() -> None:
    program = Path(sys.argv[1]).resolve()
    readme = ROOT / "README.md"
    text = readme.read_text(encoding="utf-8")
    words = COMMAND.search(text)[1].split()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "poecal-out"
        run = subprocess.run([program, *words, "--out", out], cwd=ROOT, capture_output=True, text=True, check=True)
        if "--picture" in sys.argv[2:]:
            picture = ["node", ROOT / "web" / "picture.mjs", out / "report.html", ROOT / "docs" / "report.png"]
            subprocess.run(picture, check=True)
    printed = run.stdout.replace(str(out), "poecal-out")
    text = OUTPUT.sub(lambda _: f"```text\n{printed}```", text, count=1)
    readme.write_text(with_real_robots(text), encoding="utf-8")


if __name__ == "__main__":
    main()
