"""Tables in memory: dicts of columns, structured arrays, data frames."""

import numpy as np
import pandas
import poecal
import polars
import pytest
from robots import elbow, session


def columns() -> dict[str, np.ndarray]:
    seen = session("point").measurements
    table = {f"joint{i + 1}[deg]": np.degrees(seen.joints[:, i]) for i in range(6)}
    return table | {f"{axis}[mm]": 1e3 * seen.positions[:, i] for i, axis in enumerate("xyz")}


def structured(table, **text) -> np.ndarray:
    dtype = [(name, float) for name in table] + [(name, kind) for name, (kind, _) in text.items()]
    array = np.empty(50, dtype=dtype)
    for name, values in [*table.items(), *((name, values) for name, (_, values) in text.items())]:
        array[name] = values
    return array


@pytest.mark.parametrize(
    "form",
    [
        dict,
        lambda it: {name: values.tolist() for name, values in it.items()},
        structured,
        lambda it: structured(it).view(np.recarray),
        lambda it: np.ma.asarray(structured(it)),
        pandas.DataFrame,
        polars.DataFrame,
    ],
)
def test_every_form_is_the_same_measurements(form):
    table = columns()
    found = poecal.Measurements.from_dataframe(form(table), elbow())
    assert found == poecal.Measurements.from_dataframe(pandas.DataFrame(table), elbow())
    assert len(found) == 50


def test_texts_of_structured_arrays_are_names():
    names = ["ball"] * 25 + ["cup"] * 25
    for kind in ["U8", "S8", object]:
        found = poecal.Measurements.from_dataframe(structured(columns(), target=(kind, names)), elbow())
        assert found.targets == names


def test_masked_positions_are_lost_beams():
    table = columns() | {"target": np.ma.masked_array(["ball"] * 50, mask=False)}
    for axis in "xyz":
        table[f"{axis}[mm]"] = np.ma.masked_array(table[f"{axis}[mm]"], mask=np.arange(50) == 7)
    with pytest.warns(poecal.PoecalWarning, match="skipped 1 measurement with an empty or zero position"):
        found = poecal.Measurements.from_dataframe(table, elbow())
    assert len(found) == 49
    with pytest.raises(poecal.MeasurementError, match="^row 7: found an empty position"):
        poecal.Measurements.from_dataframe(table, elbow(), strict=True)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"target": "ball"}, "frame: found the text `ball` as column `target`, expected a value for each row"),
        ({"x[mm]": 3.0}, "frame: found 3.0 as column `x[mm]`, expected a value for each row"),
        ({"x[mm]": [1.0]}, "frame: found 1 values in column `x[mm]`, expected 50 as in the first"),
        ({"x[mm]": [[1.0]] * 50}, "frame: row 0: found list in column `x[mm]`, expected a number or a text"),
        ({"x[mm]": np.ones((50, 1))}, "frame: row 0: found ndarray in column `x[mm]`, expected a number or a text"),
    ],
)
def test_columns_that_are_none_are_refused(change, sentence):
    with pytest.raises(poecal.OptionError) as raised:
        poecal.Measurements.from_dataframe(columns() | change, elbow())
    assert str(raised.value) == sentence


@pytest.mark.parametrize("table", [[1, 2], None, 5, "rows.csv", np.ones((50, 9))])
def test_what_is_no_table_is_refused(table):
    with pytest.raises(poecal.OptionError, match="^frame: found .*, expected a data frame .*, a dict of columns, or a structured array$"):
        poecal.Measurements.from_dataframe(table, elbow())
