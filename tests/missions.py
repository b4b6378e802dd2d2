"""Scenarios for tests, built of dictionaries: a short move, a mission with all that a log can hold, and their runs."""

import json

import numpy as np

from ospace import scenario

TABLES = ("name", "robot", "target", "limits", "control", "noise")
PLANE = [True, True, False, False, False, False]
PLANAR = {"model": "planar_2r", "joints": {"joint_1": "20 deg", "joint_2": "60 deg"}}
REST = {"name": "rest", "type": "damping"}
TIP = {"name": "tip", "type": "position", "point": "end_effector", "axes": PLANE}
SHIFT = {"shift": ["-1 cm", "1 cm", 0], "duration": "0.2 s"}
GRASP = {"hand": "end_effector", "fixture": "grapple", "position": float("inf"), "angle": float("inf")}


def phase(name, *tasks, **keys):
    return {"name": name, **keys, "task": tasks}


def toml(*phases, tasks=(), disturbances=(), mass_errors=(), **tables):
    """Return the TOML of a scenario; a key whose value is None is left out. An empty list of tasks is written."""
    lines = _table("", {"name": tables.get("name")})
    for name in TABLES[1:]:
        own = tables.get(name)
        if isinstance(own, list):
            for one in own:
                lines += _table(f"[[{name}]]", one)
        else:
            lines += _table(f"[{name}]", own)
    for task in tasks:
        lines += _table("[[task]]", task)
    for head, own in (("[[disturbance]]", disturbances), ("[[mass_error]]", mass_errors)):
        for one in own:
            lines += _table(head, one)
    for one in phases:
        lines += _table("[[phase]]", {key: value for key, value in one.items() if key != "task" or value == []})
        for task in one["task"]:
            lines += _table("[[phase.task]]", task)
    return "\n".join(lines) + "\n"


def _table(head, content):
    if content is None:
        return []
    return [head, *(f"{key} = {_value(value)}" for key, value in content.items() if value is not None)]


def _value(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return repr(value) if isinstance(value, float) else json.dumps(value)


def short(*later, wait=None, move=None, tip=None, tasks=(REST,), control=None, **tables):
    """Return a scenario of 0.35 s: planar_2r waits, then moves its tip. What is given is added to its table."""
    first = {"duration": "0.05 s", "timeout": "1 s"} | (wait or {})
    moved = TIP | {"goal": SHIFT, "completion": {"position": "1 mm", "hold": "0.1 s"}} | (tip or {})
    return toml(
        phase("wait, a little", **first),
        phase("move", moved, **{"timeout": "0.4 s"} | (move or {})),
        *later,
        tasks=tasks,
        control={"step": "5 ms", "period": "10 ms"} | (control or {}),
        **{"name": "A short one", "robot": PLANAR} | tables,
    )


SHORT = short()
MISSION = toml(
    phase(
        "reach",
        TIP | {"goal": SHIFT, "completion": {"position": "1 mm"}},
        timeout="1 s",
        grasp=GRASP,
    ),
    phase("carry", {"name": "rest", "type": "posture"}, duration="0.1 s", timeout="1 s", release=True),
    phase(
        "leave",
        TIP | {"type": "pose", "axes": [True, False, False, False, False, True]},
        {"name": "look", "type": "look_at", "point": "end_effector", "weight": 1e-3},
        duration="0.1 s",
        timeout="1 s",
    ),
    name="A short mission",
    robot=PLANAR | {"rpy": ["30 deg", "-40 deg", "50 deg"]},
    target={"model": "target", "spin": [0, 0, "1 deg/s"]},
    control={"step": "1 ms", "period": "2 ms"},
    tasks=[{"name": "base", "type": "base_attitude", "weight": 1e-4}],
)


def written(folder, text=SHORT):
    """Return the file of a scenario."""
    file = folder / "made.toml"
    file.write_text(text)
    return file


def loaded(folder, text=SHORT):
    return scenario.load(written(folder, text))


def flown(folder, text=MISSION):
    """Return the run of a scenario."""
    return scenario.run(loaded(folder, text))


def reaching(*, robot=None, target=None, wait=None, go=None, tip=None):
    """Return a scenario in which the tip follows a knob. What is given is added to its table."""
    body = {"mass": 50, "inertia": [3, 4, 5], "frames": {"knob": {"position": [0.2, 0, 0]}}}
    follow = {"name": "tip", "type": "pose", "point": "end_effector", "goal": {"follow": "knob", "duration": "4 s"}}
    return toml(
        phase("wait", **{"duration": "1 s", "timeout": "2 s"} | (wait or {})),
        phase("go", follow | {"completion": {"position": "1 mm"}} | (tip or {}), **{"timeout": "10 s"} | (go or {})),
        robot=PLANAR | (robot or {}),
        target={"position": [1.0, 0.5, 0], "body": body} | (target or {}),
        tasks=[REST],
    )


def at_cycles(run, phase):
    """Return states at the cycles of a phase, by the times of the records."""
    segment = run.segments[phase.segment]
    records = [int(np.argmin(np.abs(segment.trajectory.time - time))) for time in phase.time]
    return segment.robot, segment.trajectory.q[records], segment.trajectory.v[records]
