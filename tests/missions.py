"""A short run with all that a log can hold: phases with tasks of their own, a grasp, a release, two joints."""

from ospace import scenario

MISSION = """
name = "A short mission"
[robot]
model = "planar_2r"
rpy = ["30 deg", "-40 deg", "50 deg"]
joints = { joint_1 = "20 deg", joint_2 = "60 deg" }
[target]
model = "target"
spin = [0, 0, "1 deg/s"]
[control]
step = "1 ms"
period = "2 ms"
[[task]]
name = "base"
type = "base_attitude"
weight = 1e-4
[[phase]]
name = "reach"
timeout = "1 s"
grasp = { hand = "end_effector", fixture = "grapple", position = inf, angle = inf }
[[phase.task]]
name = "tip"
type = "position"
point = "end_effector"
axes = [true, true, false, false, false, false]
goal = { shift = ["-1 cm", "1 cm", 0], duration = "0.2 s" }
completion = { position = "1 mm" }
[[phase]]
name = "carry"
duration = "0.1 s"
timeout = "1 s"
release = true
[[phase.task]]
name = "rest"
type = "posture"
[[phase]]
name = "leave"
duration = "0.1 s"
timeout = "1 s"
[[phase.task]]
name = "tip"
type = "pose"
point = "end_effector"
axes = [true, false, false, false, false, true]
[[phase.task]]
name = "look"
type = "look_at"
point = "end_effector"
weight = 1e-3
"""


def flown(folder, text=MISSION):
    """Return the run of a scenario."""
    file = folder / "mission.toml"
    file.write_text(text)
    return scenario.run(scenario.load(file))
