"""`poecal.guess_columns` and `poecal.recalibrate`, as the program guesses and recalibrates."""

import numpy as np
import poecal
import pytest
from robots import elbow


@pytest.fixture
def foreign(tmp_path):
    made = poecal.simulate(elbow(), kind="point", count=40, seed=2)
    made.write(tmp_path / "made")
    lines = (tmp_path / "made/measurements.csv").read_text().splitlines()
    at = next(k for k, line in enumerate(lines) if not line.startswith("#"))
    names = [f"Axis {k + 1}" for k in range(6)] + ["Tx", "Ty", "Tz"]
    path = tmp_path / "foreign.csv"
    path.write_text("\n".join([",".join(names), *(",".join(line.split(",")[:9]) for line in lines[at + 1 :])]) + "\n")
    return made, path


def test_a_guessed_mapping_reads_the_file(foreign, tmp_path):
    made, path = foreign
    guess = poecal.guess_columns(path, made.nominal)
    assert guess.columns[6:] == ["Tx", "Ty", "Tz"] and guess.mapping == str(guess)
    assert len(guess.to_dataframe()) == len(guess["fields"]) and set(guess.chosen.values()) & {"Axis 1"}
    chosen = {key: "" for key in guess.chosen if guess.chosen[key] == "Axis 6"}
    without = poecal.guess_columns(path, made.nominal, columns=chosen)
    assert without.missing and "no column for" in without.answer
    (tmp_path / "columns.toml").write_text(guess.mapping)
    assert len(poecal.Measurements.from_csv(path, made.nominal, columns=tmp_path / "columns.toml")) == 40
    with pytest.raises(poecal.Error, match="columns: found a number|columns: found 3"):
        poecal.guess_columns(path, made.nominal, columns=3)


def test_the_axis_of_one_joint_is_calibrated_anew(tmp_path):
    made = poecal.simulate(elbow(), kind="point", count=60, seed=5)
    calibration = poecal.calibrate(made.nominal, made.measurements)
    again = poecal.recalibrate(calibration, made.measurements, made.measurements, part="joint3", device="known")
    entry = again.to_dict()["recalibrated"][0]
    assert entry["joint"] == "joint3" and entry["part"] == "zero" and abs(entry["size"]) < 1e-3
    zero = np.zeros(6)
    assert np.allclose(again.predict([zero])[0], calibration.predict([zero])[0], atol=1e-4)
    with pytest.raises(poecal.Error, match="nowhere"):
        poecal.recalibrate(calibration, made.measurements, part="nowhere")
