"""A scenario from anywhere is read or refused with the key, in no time and memory; none is a traceback."""

import os
import random
import re

import missions
import pytest

from ospace import OspaceError, scenario
from ospace.scenario.errors import ScenarioError

MUTATIONS = int(os.environ.get("OSPACE_MUTATIONS", "100"))
SHORT = missions.short()
HEX = "0x" + "f" * 10_000
PARTS = 30_000


def changed(old, new):
    assert old in SHORT
    return SHORT.replace(old, new, 1)


def dotted(part, dot=".", end=" = 1\n"):
    return dot.join([part] * PARTS) + end


MANY = range(80_000)
HOSTILE = {
    "a key of 30,000 parts": (dotted("a"), "a key of more than 32 parts (at line 1)"),
    "in quotes": (SHORT + dotted('"a"'), f"a key of more than 32 parts (at line {SHORT.count(chr(10)) + 1})"),
    "in single quotes": (dotted("'a'"), "a key of more than 32 parts"),
    "with spaces": (dotted("a", " . "), "a key of more than 32 parts"),
    "a table of 30,000 parts": ("[" + dotted("a", end="]\n"), "a key of more than 32 parts"),
    "inside a table": ("x = { " + dotted("a", end=" = 1 }\n"), "a key of more than 32 parts"),
    "400 digits": (changed('timeout = "1 s"', "timeout = 1" + "0" * 400), "phase[0].timeout: a number of 1329 bits"),
    "5000 digits": (changed('timeout = "1 s"', "timeout = 1" + "0" * 5000), "a number of 1000 digits or more (at"),
    "hex": (changed('timeout = "1 s"', f"timeout = {HEX}"), "phase[0].timeout: a number of 40000 bits must be"),
    "a name in hex": (changed('"move"', HEX), "phase[1].name: a number of 40000 bits is not a text"),
    "hex in a list": (changed("[robot]", f"[robot]\nposition = [{HEX}]"), "robot.position: a list with a number of"),
    "hex in a table": (changed("[robot]", f"[robot]\nposition = {{ a = {HEX} }}"), "robot.position: a table with a"),
    "unknown keys": ("".join(f"k{k} = 1\n" for k in MANY), "79980 more unknown keys"),
    "unknown joints": (
        missions.short(robot={"model": "planar_2r"}) + "[robot.joints]\n" + "".join(f"k{k} = 1\n" for k in MANY),
        "robot 'planar_2r' has no joint 'k49'; known: joint_1, joint_2\n  … and 79950 more",
    ),
    "tasks": (SHORT + "[[phase.task]]\n" * 60_000, "phase[1].task: 60001 tables: give at most 1000"),
    "phases": (SHORT + "[[phase]]\n" * 60_000, "phase: 60002 tables: give at most 1000"),
    "a long name": (changed('"move"', f'"{"m" * 900_000}"'), "phase[1].name: 'mmm"),
    "a control character": (changed('"move"', r'"a\u001b[2Jb"'), "has the control character U+001B: leave it out"),
    "another": (changed('"A short one"', r'"a\u009b2Jb"'), "name: 'a\\x9b2Jb' has the control character U+009B"),
    "a joint that a terminal obeys": (changed("joint_1", r'"a\u001b]0;t\u0007"'), r"robot.joints.a\x1b]0;t\x07: robot"),
    "limits of 1e308": (SHORT + "[limits]\nacceleration = 1e308\n", "limits.acceleration: 1e+308 must be at most"),
    "deep lists": ("a = " + "[" * 100_000 + "]" * 100_000, "values are nested too deep"),
    "deep tables": ("a = " + "{a=" * 100_000 + "1" + "}" * 100_000, "values are nested too deep"),
    "UTF-16": (SHORT.encode("utf-16"), "is not UTF-8 text"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_scenario_is_refused_and_says_where(tmp_path, name):
    text, said = HOSTILE[name]
    file = tmp_path / "hostile.toml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ScenarioError) as refused:
        scenario.load(file)
    assert said in str(refused.value)
    assert len(str(refused.value)) < 10_000
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", str(refused.value))


def test_a_byte_order_mark_is_read(tmp_path):
    file = tmp_path / "marked.toml"
    file.write_bytes(b"\xef\xbb\xbf" + SHORT.encode())
    assert scenario.load(file).name == "A short one"


@pytest.mark.parametrize(("name", "reason"), [("pipe", "is not a regular file"), ("", "is a folder"), ("a\0b", "null")])
def test_a_pipe_is_no_scenario(tmp_path, name, reason):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ScenarioError, match=reason):
        scenario.load(tmp_path / name)


VALUES = ["0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "true", '""', '"a"', '"20 deg"', '"1e308 rad/s"', "[]"]
VALUES += ["{}", "[1, 2, 3]", "[1e308, 1e308, 1e308]", "[[]]", "1" + "0" * 400, HEX, "1979-05-27", '"\\u001b[2J"']
VALUES += ['"end_effector"', '"joint_1"', '"pose"', '"floating"', "{ a = 1 }", "'$\\frac{$'", '"' + "x" * 300 + '"']


def mutated(seed):
    """Return a scenario with lines changed, doubled, swapped or left out, or with other letters."""
    chance = random.Random(seed)
    lines = chance.choice([SHORT, missions.MISSION, missions.reaching()]).splitlines()
    for _ in range(chance.choice([1, 1, 1, 2, 5])):
        k, way = chance.randrange(len(lines)), chance.randrange(8)
        if way < 4 and "=" in lines[k]:
            lines[k] = f"{lines[k].partition('=')[0]}= {chance.choice(VALUES)}"
        elif way == 4:
            del lines[k]
        elif way == 5:
            lines.insert(chance.randrange(len(lines)), lines[k])
        elif way == 6:
            lines[k] = re.sub(r"-?\d+(\.\d+)?", lambda found: chance.choice(["0", "-1", "1e308", "1e9"]), lines[k])
        else:
            at = chance.randrange(len(lines[k]) + 1)
            lines[k] = lines[k][:at] + chance.choice("\"'[]{}=.#,\\é0") + lines[k][at + 1 :]
        if not lines:
            break
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("seed", range(MUTATIONS))
def test_a_mutated_scenario_is_read_or_refused(tmp_path, seed):
    text = mutated(seed)
    try:
        missions.loaded(tmp_path, text)
    except OspaceError as error:
        refused = str(error)
    else:
        return
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f-\x9f]", refused)
