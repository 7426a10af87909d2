"""The corrected model computed as docs/corrected-model.md describes, against the program, with every term."""

import json
import re

import numpy as np
from program import ELBOW, ROOT, poecal, predict

TERMS = "sag=1e-3,tilt=5e-4,ratio=1e-4,harmonics=2e-4,wobble=1e-4,backlash=2e-4,factors=2e-5,payload=1e-4,shift=1e-4,runout=5e-5"
MASS = '<inertial><origin xyz="0.1 0.05 0.02"/><mass value="{}"/></inertial>'


def test_the_documented_formulas_are_those_of_the_program(tmp_path):
    mass = iter(range(12, 0, -1))
    text = re.sub(r'<link name="(\w+)"/>', lambda link: f'<link name="{link[1]}">{MASS.format(next(mass))}</link>', ELBOW.read_text())
    model = tmp_path / "heavy.urdf"
    model.write_text(text)
    poecal("simulate", model, "--terms", TERMS, "--count", 60, "--out", tmp_path / "made", "--quiet")
    factors = [*(f"approach_joint{k}" for k in range(1, 7)), "temperature", "payload"]
    measured = [tmp_path / "made" / name for name in ("nominal.urdf", "measurements.csv")]
    sizes = ["--corrections", TERMS, "--factors", ",".join(factors)]
    poecal("calibrate", *measured, *sizes, "--out", tmp_path / "results", "--report", "none", "--quiet")
    corrected = json.loads((tmp_path / "results/calibration.json").read_text())["corrected"]
    used = {re.sub(r"\d+$", "", term) for joint in corrected["joints"] for term in joint.get("terms", {})}
    assert used == {"sag", "masses", "ratio", "sin", "cos", "factor", "payload"}

    page = (ROOT / "docs/corrected-model.md").read_text()
    block = next(block for block in re.findall(r"```python\n(.*?)```", page, re.S) if "def predict" in block)
    documented = {}
    exec(block[: block.index("calibration = json.load")], documented)

    values = {f"joint{k}": 0.3 * k for k in range(1, 7)} | dict.fromkeys(factors, 1.0) | {"temperature": 26.0, "payload": 3.0}
    ours = documented["predict"](corrected, values)
    rows = tmp_path / "rows.csv"
    heads = [f"{name}[rad]" if name.startswith("joint") else name for name in values]
    rows.write_text(",".join(heads) + "\n" + ",".join(map(str, values.values())) + "\n")
    apart = np.abs(predict(tmp_path / "results/calibration.json", rows)[0, :3] - ours[:3, 3]).max()
    print(f"{apart:.1e} m apart, {len(used)} kinds of terms")
    assert apart < 1e-12
