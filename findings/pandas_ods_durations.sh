#!/usr/bin/env bash
# Times in an ODS workbook, read by pandas.
#
# Expected: a cell of a time has its value in the file, `PT00H01M30.250S`, whatever it is shown as; read_excel
# reads that, as it does for numbers, percentages, currencies and dates.
# What happens: the engine that pandas takes for .ods, odf, reads the text that is shown, as a time of the day.
# 90.25 seconds in a cell of the format MM:SS are shown as 01:30 and read as half past one in the morning; in
# HH:MM:SS they lose the quarter of a second. The same file by engine="calamine" is right, and dates keep
# their milliseconds by both. Nothing is said, and the documentation speaks of no format.
# Whom it hurts: whoever reads a log of joints and measurements, with the time since its start, as saved from
# LibreOffice: minutes become hours, rates are sixty times too slow, and at 4 Hz four rows have one time.
# poecal: reads the values of cells, whatever they are shown as, and refuses a time where a length or an angle
# should be, with its cell and its value.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check pandas==3.1.1 odfpy==1.4.1 python-calamine==0.9.1 numpy==2.4.6
cd "$here"
"$here/venv/bin/python" - <<'PY'
import sys
from datetime import time
from importlib.metadata import version
import pandas
from odf.opendocument import OpenDocumentSpreadsheet
from odf.table import Table, TableCell, TableRow
from odf.text import P

print(", ".join(f"{name} {version(name)}" for name in ("pandas", "odfpy", "python-calamine")))
SECONDS = [88.5 + 0.25 * row for row in range(9)]


def written(name, shown):
    """A log whose times are shown by a format, as spreadsheet programs write them: value and text."""
    document, table = OpenDocumentSpreadsheet(), Table(name="log")
    document.spreadsheet.addElement(table)

    def row(*cells):
        line = TableRow()
        for cell, text in cells:
            cell.addElement(P(text=text))
            line.addElement(cell)
        table.addElement(line)

    row(*((TableCell(valuetype="string"), text) for text in ("time", "stamp", "joint1")))
    for seconds in SECONDS:
        minutes, rest = divmod(seconds, 60)
        row(
            (TableCell(valuetype="time", timevalue=f"PT00H{int(minutes):02}M{rest:09.6f}S"), shown(minutes, rest)),
            (TableCell(valuetype="date", datevalue=f"2026-11-30T10:{int(minutes):02}:{rest:09.6f}"), "30.11.26"),
            (TableCell(valuetype="float", value=0.01 * seconds), f"{0.01 * seconds:.1f}"),
        )
    document.save(name)


def of_day(value):
    return value.hour * 3600 + value.minute * 60 + value.second + value.microsecond * 1e-6


unchanged = True
for name, shown in (
    ("MM:SS", lambda minutes, rest: f"{int(minutes):02}:{int(rest):02}"),
    ("HH:MM:SS", lambda minutes, rest: f"00:{int(minutes):02}:{int(rest):02}"),
    ("HH:MM:SS.000", lambda minutes, rest: f"00:{int(minutes):02}:{rest:06.3f}"),
):
    written("log.ods", shown)
    for engine in (None, "calamine"):
        table = pandas.read_excel("log.ods", engine=engine)
        times = [of_day(value) for value in table["time"]]
        stamps = [of_day(value.time()) for value in table["stamp"]]
        right = [times == SECONDS, [stamp - 36000 for stamp in stamps] == SECONDS]
        print(f"  shown as {name:13} engine {engine or 'none':9} {table['time'][7]} for 90.25 s, {len(set(times))} different times of {len(times)}, dates right: {right[1]}")
        unchanged = unchanged and right[1] and list(table["joint1"]) == [0.01 * seconds for seconds in SECONDS]
        if engine or name == "HH:MM:SS.000":
            unchanged = unchanged and right[0]
        elif name == "HH:MM:SS":
            unchanged = unchanged and times == [int(seconds) for seconds in SECONDS]
        else:
            unchanged = unchanged and table["time"][7] == time(1, 30) and times == [60 * int(seconds) for seconds in SECONDS]
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
