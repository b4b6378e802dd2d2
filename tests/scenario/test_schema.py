"""The JSON Schema of scenarios: it describes every key, takes what is right, and refuses what `load` refuses."""

import json
import subprocess
import sys
import tomllib

import jsonschema
import missions
import pytest
from scenario_schema import tables_of

import ospace
from ospace.cli.main import main
from ospace.quantities import UNITS
from ospace.scenario.schema import TASKS, ScenarioTable, json_schema
from ospace.scenario.units import LARGEST, Quantity

SCHEMA = json_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)


def quantities(node):
    """Yield the schemas of quantities within a schema."""
    if isinstance(node, dict):
        if "unit" in node and "anyOf" in node:
            yield node
        for part in node.values():
            yield from quantities(part)
    elif isinstance(node, list):
        for part in node:
            yield from quantities(part)


def test_the_schema_is_a_valid_json_schema():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    json.dumps(SCHEMA, allow_nan=False)


def test_the_schema_describes_every_key():
    tables = list(tables_of(SCHEMA))
    assert len(tables) > len(TASKS) + 10
    for table, properties in tables:
        for key, schema in properties.items():
            assert schema.get("description"), f"{table}.{key}"


def test_the_schema_gives_unit_and_bounds_of_every_quantity():
    found = list(quantities(SCHEMA))
    assert len(found) > 80
    units = {next(iter(one), "1") for one in UNITS.values()}
    for one in found:
        number, text, *infinite = one["anyOf"]
        assert one["unit"] in units
        assert number["maximum"] <= max(LARGEST.values())
        assert "minimum" in number or "exclusiveMinimum" in number
        assert text["pattern"]
        assert all(wide["exclusiveMinimum"] == sys.float_info.max for wide in infinite)


def test_the_schema_gives_defaults():
    control = SCHEMA["$defs"]["ControlTable"]["properties"]
    read = ScenarioTable.model_validate({}).control
    for key in ("period", "step", "solver", "integrator"):
        assert control[key]["default"] == getattr(read, key)


@pytest.mark.parametrize("name", ospace.models.scenarios())
def test_the_schema_takes_scenarios_that_come_with_ospace(name):
    VALIDATOR.validate(tomllib.loads(ospace.models.scenario(name).read_text()))


def test_the_schema_takes_a_mission_with_infinite_bounds():
    VALIDATOR.validate(tomllib.loads(missions.MISSION))


@pytest.mark.parametrize(
    ("was", "now"),
    [
        ('model = "planar_2r"', 'modl = "planar_2r"'),
        ('model = "planar_2r"', "model = 3"),
        ('model = "planar_2r"', 'model = "planar_2r"\nquaternion = [0, 0, 0, 1]'),
        ('spin = [0, 0, "1 deg/s"]', 'spin = [0, 0, "1 deg"]'),
        ('spin = [0, 0, "1 deg/s"]', 'spin = [0, "1 deg/s"]'),
        ('spin = [0, 0, "1 deg/s"]', "body = { mass = 1, inertia = [1, 1, 1] }"),
        ('period = "2 ms"', "period = 11.0"),
        ('period = "2 ms"', 'integrator = "rk5"'),
        ('timeout = "1 s"', "timeout = 0"),
        ('timeout = "1 s"', ""),
        ('timeout = "1 s"', 'timeout = "1 kg"'),
        ('timeout = "1 s"', "timeout = true"),
        ("weight = 0.0001", "weight = -1"),
        ("weight = 0.0001", "weight = 1e7"),
        ("weight = 0.0001", "stifness = 1"),
        ("weight = 0.0001", "level = 1.5"),
        ('type = "base_attitude"', 'type = "base_atitude"'),
        ('type = "posture"', 'type = "posture"\ngoal = "hold"'),
        ('fixture = "grapple"', 'fixtur = "grapple"'),
        ('goal = { shift = ["-1 cm", "1 cm", 0], ', "goal = { "),
        ('goal = { shift = ["-1 cm", "1 cm", 0], ', "goal = { hold = true, shift = [0, 0, 0], "),
        ("axes = [true, true, false, false, false, false]", "axes = [true, true]"),
        ("axes = [true, true, false, false, false, false]", 'axes = "lineal"'),
        ("release = true", "release = 1"),
    ],
)
def test_the_schema_refuses_what_load_refuses(load, was, now):
    assert was in missions.MISSION
    text = missions.MISSION.replace(was, now, 1)
    assert not VALIDATOR.is_valid(tomllib.loads(text))
    with pytest.raises(ospace.ScenarioError):
        load(text)


@pytest.mark.parametrize("dimension", UNITS)
def test_the_schema_takes_every_way_to_write_a_unit(dimension):
    quantity = Quantity(dimension)
    (schema,) = quantities(quantity.__get_pydantic_json_schema__(None, None))
    for unit in UNITS[dimension]:
        for written in (unit, unit.replace("^2", "²"), unit.replace(" ", "·"), unit.replace(" ", "  ")):
            text = f" -2.5e1 {written}"
            assert quantity.read(text) < 0.0
            jsonschema.validate(text, schema)
    for wrong in ("1 parsec", "one", "", "1..0 " + next(iter(UNITS[dimension]), "")):
        with pytest.raises(ValueError, match="is not a"):
            quantity.read(wrong)
        assert not jsonschema.Draft202012Validator(schema).is_valid(wrong)


def test_the_command_prints_the_schema(capsys):
    with pytest.raises(SystemExit) as leaving:
        main(["run", "--schema"])
    assert leaving.value.code == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA


@pytest.mark.parametrize("code", ["import ospace", "from ospace.cli import main; main.parser()"])
def test_pydantic_is_imported_for_scenarios_alone(code):
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; {code}; sys.exit('pydantic' in sys.modules)"], timeout=60, check=False
    )
    assert done.returncode == 0


def test_a_scenario_loads_no_splines_and_no_analysis():
    names = "'scipy.interpolate', 'scipy.spatial', 'ospace.analysis'"
    code = f"import sys, ospace.scenario; sys.exit(any(name in sys.modules for name in ({names})))"
    assert subprocess.run([sys.executable, "-c", code], timeout=60, check=False).returncode == 0
