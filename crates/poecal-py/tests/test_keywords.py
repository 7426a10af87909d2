"""Keywords with a typing mistake are answered with the nearest; numbers may have their own unit."""

import ast
import inspect
import warnings
from importlib.resources import files

import numpy as np
import poecal
import pytest
from robots import elbow


@pytest.fixture(scope="module")
def made() -> poecal.Simulation:
    return poecal.simulate(elbow(), kind="point", count=60, seed=5)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda made: poecal.calibrate(made.nominal, made.measurements, correctons="off"), "calibrate: found the keyword `correctons`, did you mean `corrections`?"),
        (lambda made: poecal.check(made.nominal, device_frme="base"), "check: found the keyword `device_frme`, did you mean `device_frame`?"),
        (lambda made: poecal.simulate(made.nominal, cont=5), "simulate: found the keyword `cont`, did you mean `count`?"),
        (lambda made: poecal.plan(made.nominal, criterium="D"), "plan: found the keyword `criterium`, did you mean `criterion`?"),
        (lambda made: poecal.Watch(made.nominal, candidate=[[0.0] * 6]), "Watch: found the keyword `candidate`, did you mean `candidates`?"),
        (lambda made: poecal.Robot.read("robot.urdf", tiplink="tool"), "read: found the keyword `tiplink`, did you mean `tip_link`?"),
        (lambda made: poecal.Measurements.from_files("a.csv", made.nominal, unit="mm"), "from_csv: found the keyword `unit`, did you mean `units`?"),
        (lambda made: made.write("out", forced=True), "write: found the keyword `forced`, did you mean `force`?"),
        (lambda made: poecal.compare(zzz=1), "compare: found the keyword `zzz`, expected one of first, second, limit_mm"),
        (lambda made: poecal.version(full=True), "version: found the keyword `full`, expected none"),
        (
            lambda made: poecal.calibrate(made.nominal, made.measurements, sigma_position_m=5e-5),
            'calibrate: found the keyword `sigma_position_m`, did you mean `sigma_position_mm`? Its numbers are in mm; a text has its own unit, as sigma_position_mm="0.05 m".',
        ),
    ],
)
def test_a_keyword_that_is_none_is_answered(made, call, said):
    with pytest.raises(TypeError) as found:
        call(made)
    assert str(found.value) == said
    assert isinstance(found.value, poecal.KeywordError) and isinstance(found.value, poecal.OptionError)
    assert found.value.__cause__ is None and found.value.__context__ is None


def test_every_public_function_answers(made):
    """Each that has keywords is called with one that has a letter too many."""
    calibration = poecal.calibrate(made.nominal, made.measurements)
    objects = [made.nominal, made.measurements, made, calibration, calibration.residuals, calibration.covariance, calibration.verdict]
    objects += [poecal.plan(made.nominal, count=8), poecal.plan(made.nominal, purpose="iso9283"), poecal.Watch(made.nominal)]
    owners = [(poecal._poecal, ()), *((type(it), (it,)) for it in objects)]
    asked = []
    for owner, this in owners:
        for name, thing in list(vars(owner).items()):
            function = getattr(owner, name)
            if name.startswith("_") or isinstance(thing, type) or not inspect.isfunction(function):
                continue
            own = () if isinstance(thing, staticmethod) else this
            for keyword in (it.name for it in inspect.signature(function).parameters.values() if it.kind is it.KEYWORD_ONLY):
                if len(keyword) > 3:
                    with pytest.raises(poecal.KeywordError, match=f"^{name}: found the keyword `{keyword}x`, did you mean `{keyword[:3]}"):
                        function(*own, **{keyword + "x": 1})
                    asked.append(f"{owner.__name__}.{name}")
    print(len(asked), "keywords of", len(set(asked)), "functions asked")
    assert {"Calibration.validate", "Calibration.predict", "Plan.write", "Residuals.errors", "Robot.from_dh", "poecal._poecal.plan"} <= set(asked)
    # All functions of the stubs were called, except those without keywords.
    stubs = files("poecal").joinpath("_poecal.pyi").read_text()
    classes = {node.name: node for node in ast.parse(stubs).body if isinstance(node, ast.ClassDef)}
    for owner, names in classes.items():
        for node in names.body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and any(len(it.arg) > 3 for it in node.args.kwonlyargs):
                assert f"{owner}.{node.name}" in asked


def test_errors_of_others_and_of_positions_stay(made):
    def stop(stage):
        return dict(stage=stage).update(1, 2, 3)

    with pytest.raises(TypeError, match="update expected at most 1 argument") as found:
        poecal.calibrate(made.nominal, made.measurements, progress=stop)
    assert not isinstance(found.value, poecal.Error)
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        poecal.calibrate(made.nominal)


def test_warnings_name_the_line_of_the_caller(made):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        poecal.calibrate(made.nominal, made.measurements[:40], residual="spatial")
    assert [it.filename for it in caught if "residual" in str(it.message)] == [__file__]


def test_a_text_has_its_own_unit(made):
    robot, rows = made.nominal, made.measurements
    same = poecal.calibrate(robot, rows, sigma_position_mm=0.05, tolerance_deg_mm=(0.5, 5.0))
    for position, tolerance in [("0.05mm", "0.5deg,5mm"), ("0.05 mm", ("0.5deg", "5mm")), (0.05, ["0.5 deg", 5.0])]:
        assert poecal.calibrate(robot, rows, sigma_position_mm=position, tolerance_deg_mm=tolerance) == same
    near = poecal.calibrate(robot, rows, sigma_position_mm="50um", tolerance_deg_mm="30arcmin,0.5cm")
    assert np.allclose(near.robot.screws, same.robot.screws, atol=1e-9)
    noises = [it.to_dict()["noise"]["sigma"]["position_mm"] for it in (near, same)]
    assert noises[0] == pytest.approx(noises[1])
    joints = rows.joints
    numbers = poecal.plan(robot, count=8, held_out_count=0, robot_error_mm=(0.2, 0.1), device_mm=(3000, 0, 500), distance_mm=(500, 6000), floor_height_mm=-700)
    texts = poecal.plan(
        robot, count=8, held_out_count=0, robot_error_mm="0.2,0.1mm", device_mm="3000,0,500mm", distance_mm="500mm,6m", floor_height_mm="-70cm"
    )
    assert np.array_equal(texts.joints, numbers.joints)
    turned = poecal.export(robot, format="toml", offset={"joint2": "0.5deg"})
    assert turned == poecal.export(robot, format="toml", offset={"joint2": np.radians(0.5)})
    calibration = same
    one, other = (calibration.compensate(joints, **most) for most in ({"max_turn_deg": 5, "max_slide_mm": "1cm"}, {"max_turn_rad": np.radians(5), "max_slide_m": 0.01}))
    assert np.array_equal(one, other)
    arrays = [poecal.Measurements.from_arrays(robot, joints=joints, positions=rows.positions, sigma_position_mm=it) for it in (0.05, "0.05mm")]
    assert arrays[0] == arrays[1]
    made_by_text = poecal.simulate(elbow(), count=5, noise_position_mm="0.1mm", terms={"sag": "1e-3rad"})
    assert made_by_text.measurements == poecal.simulate(elbow(), count=5, noise_position_mm=0.1, terms={"sag": 1e-3}).measurements


@pytest.mark.parametrize(
    ("option", "said"),
    [
        ({"sigma_position_mm": "0.05"}, "sigma_position_mm: found the text `0.05`, expected a number, or a text of one with its unit, like \"0.05mm\""),
        ({"sigma_position_mm": "much"}, "sigma_position_mm: found the text `much`, expected a number, or a text of one with its unit, like \"0.05mm\""),
        ({"sigma_position_mm": "1deg"}, "sigma_position_mm: found the unit `deg`, expected a length"),
        ({"sigma_rotation_deg": "-1deg"}, "sigma_rotation_deg: found -1, expected a standard deviation above 0"),
        ({"tolerance_deg_mm": "5mm,0.5deg"}, r"tolerance_deg_mm\[0\]: found the unit `mm`, expected an angle"),
        ({"tolerance_deg_mm": "wide"}, "tolerance_deg_mm: found the text `wide`, expected two numbers"),
        ({"corrections": {"sag": "1kg"}}, r'corrections\["sag"\]: found the unit `kg`, expected one of'),
    ],
)
def test_a_wrong_unit_is_one_sentence(made, option, said):
    with pytest.raises(poecal.InputError, match=said):
        poecal.calibrate(made.nominal, made.measurements, **option)


def test_both_spellings_of_one_option_are_refused(made):
    calibration = poecal.calibrate(made.nominal, made.measurements)
    with pytest.raises(poecal.OptionError, match="max_turn_deg: found max_turn_rad too, expected one of the two"):
        calibration.compensate(made.measurements.joints, max_turn_deg=2, max_turn_rad=0.03)
    with pytest.raises(poecal.OptionError, match="max_slide_mm: found 0, expected a number above 0"):
        calibration.compensate(made.measurements.joints, max_slide_mm=0)
