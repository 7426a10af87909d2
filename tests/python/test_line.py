"""A line of robots by other tools: its ledger has the documented types in DuckDB and polars, and the panel of Grafana reads existing columns."""

import csv
import json
import re
import subprocess

import duckdb
import polars
import pytest
from program import ROOT, poecal, program
from snippets import blocks

STATION = """
poecal_station = 1
inbox = "inbox/{serial}/{date}.csv"
results = "results/{serial}/{date}"
model = "robot.urdf"
accept = ["0.5mm"]
"""
ROBOTS = 10_000
DUCKDB = {"text": r"VARCHAR|DATE|TIMESTAMP.*", "integer": "BIGINT", "number": "DOUBLE", "boolean": "BOOLEAN", "list": r"STRUCT\(.*\)\[\]"}
POLARS = {"text": "String", "integer": "Int64", "number": "Float64", "boolean": "Boolean", "list": r"List\(Struct\(.*\)\)"}


def documented() -> dict[str, str]:
    """The type of each key, in the order of the page."""
    text = (ROOT / "docs/file-formats.md").read_text(encoding="utf-8")
    section = text.split("### A line of robots")[1].split("\n### ")[0]
    return dict(re.findall(r"^\| `(\w+)` \| (text|integer|number|boolean|list) \|", section, re.M))


@pytest.fixture(scope="module")
def line(tmp_path_factory):
    """A ledger of two robots and a broken file, and one of ten thousand that repeats their lines."""
    folder = tmp_path_factory.mktemp("line")
    (folder / "robot.urdf").write_bytes((ROOT / "examples/elbow/robot.urdf").read_bytes())
    (folder / "station.toml").write_text(STATION)
    for robot in range(3):
        made = folder / f"made{robot}"
        poecal("simulate", folder / "robot.urdf", "--kind", "point", "--count", 60, "--terms", "harmonics=0.0005", "--seed", robot, "--out", made, "--quiet")
        place = folder / f"inbox/SN{robot}/2026-03-0{robot + 1}.csv"
        place.parent.mkdir(parents=True)
        place.write_bytes((made / "measurements.csv").read_bytes() if robot else b"joint1[deg],x[mm]\n1,oops\n")
    # One file is broken.
    assert subprocess.run([program(), "fleet", folder / "station.toml", "--quiet"], capture_output=True).returncode == 1
    poecal("fleet", "report", folder / "station.toml", "--quiet")
    rows = [json.loads(text) for text in (folder / "fleet.jsonl").read_text().splitlines()]
    assert len(rows) == 3 and rows[1]["terms"] and not rows[0]["terms"]
    with open(folder / "many.jsonl", "w") as file:
        file.writelines(json.dumps({**rows[number % 3], "serial": f"SN{number:05d}"}) + "\n" for number in range(ROBOTS))
    return folder


def test_every_line_has_the_documented_keys_in_their_order(line):
    for text in (line / "fleet.jsonl").read_text().splitlines():
        assert list(json.loads(text)) == list(documented())


def test_duckdb_opens_ten_thousand_robots_with_the_documented_types(line):
    found = {name: kind for name, kind, *_ in duckdb.sql(f"DESCRIBE SELECT * FROM '{line / 'many.jsonl'}'").fetchall()}
    assert list(found) == list(documented())
    for key, kind in documented().items():
        assert re.fullmatch(DUCKDB[kind], found[key], re.S), (key, found[key])
    assert duckdb.sql(f"SELECT count(DISTINCT serial) FROM '{line / 'many.jsonl'}'").fetchall() == [(ROBOTS,)]
    # From the joints, and through Parquet.
    duckdb.sql(f"COPY (FROM '{line / 'many.jsonl'}') TO '{line / 'many.parquet'}'")
    joints = f"SELECT c.joint, c.sigma_offset FROM (SELECT unnest(corrections) AS c FROM '{line / 'many.parquet'}')"
    kinds = {name: kind for name, kind, *_ in duckdb.sql(f"DESCRIBE {joints}").fetchall()}
    assert kinds == {"joint": "VARCHAR", "sigma_offset": "DOUBLE"}
    whole = sum(len(json.loads(text)["corrections"]) for text in (line / "many.jsonl").read_text().splitlines())
    assert len(duckdb.sql(joints).fetchall()) == whole > 0


def test_polars_opens_ten_thousand_robots_with_the_documented_types(line):
    found = polars.read_ndjson(line / "many.jsonl", infer_schema_length=None)
    assert found.height == ROBOTS and found.columns == list(documented())
    for key, kind in documented().items():
        assert re.fullmatch(POLARS[kind], str(found.schema[key]), re.S), (key, found.schema[key])
    terms = found.explode("terms").unnest("terms", separator="_").drop_nulls("terms_amplitude")
    assert terms.height > 0 and terms.schema["terms_found"] == polars.Boolean


def test_the_panel_of_grafana_reads_columns_that_there_are(line):
    panel = next(block for block in blocks(ROOT / "docs/howto/line.md") if block.notes.get("file") == "line/panel.json")
    with open(line / "fleet.csv", newline="") as file:
        names = next(csv.reader(file))
    columns = json.loads(panel.text)["targets"][0]["columns"]
    assert columns and all(column["selector"] in names for column in columns)
