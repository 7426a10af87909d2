"""A calibration.json that the program writes conforms to its JSON Schema."""

import json

import jsonschema
import numpy as np
import pytest
from program import ELBOW, ROOT, poecal, simulated_session

SCHEMA = json.loads((ROOT / "docs/calibration.schema.json").read_text())


@pytest.fixture
def calibration(tmp_path) -> dict:
    rng = np.random.default_rng(3)
    joints = {f"joint{i}": rng.uniform(-0.6, 1.4, 40) for i in range(1, 7)}
    measurements, _ = simulated_session(tmp_path, joints)
    return json.loads(poecal("calibrate", ELBOW, measurements, "--out", tmp_path / "out", "--json"))


def test_the_schema_is_valid_and_the_programs_own():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert json.loads(poecal("schema")) == SCHEMA


def test_a_calibration_fits_the_schema(calibration):
    jsonschema.validate(calibration, SCHEMA, cls=jsonschema.Draft202012Validator)


@pytest.mark.parametrize("key", sorted(SCHEMA["required"]))
def test_a_calibration_without_a_key_does_not_fit(calibration, key):
    del calibration[key]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(calibration, SCHEMA, cls=jsonschema.Draft202012Validator)
