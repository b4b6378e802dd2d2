"""A robot of which a hinge has no drive, through a whole run."""

import missions
import numpy as np

LINK = '<link name="{0}"><inertial><origin xyz="{1}"/><mass value="{2}"/>{3}</inertial></link>'
INERTIA = '<inertia ixx="{0}" iyy="{0}" izz="{0}" ixy="0" ixz="0" iyz="0"/>'
JOINT = (
    '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><origin xyz="{3}"/><axis xyz="{4}"/>'
    '<limit lower="-2" upper="2" effort="{5}" velocity="{6}"/></joint>'
)
ROBOT = "".join(
    [
        '<robot name="flapping">',
        LINK.format("bus", "0 0 0", 200, INERTIA.format(30)),
        LINK.format("upper", "0.3 0 0", 6, INERTIA.format(0.3)),
        LINK.format("fore", "0.3 0 0", 4, INERTIA.format(0.2)),
        LINK.format("panel", "0 1 0", 15, INERTIA.format(4)),
        JOINT.format("shoulder", "bus", "upper", "0.5 0 0.2", "0 1 0", 80, 2),
        JOINT.format("elbow", "upper", "fore", "0.6 0 0", "0 1 0", 60, 2),
        JOINT.format("hinge", "bus", "panel", "0 0.5 0", "1 0 0", 0, 0),
        "</robot>",
    ]
)
REACH = {
    "name": "tip",
    "type": "position",
    "point": "fore",
    "axes": [True, False, True, False, False, False],
    "stiffness": 100.0,
    "weight": 10.0,
    "goal": {"shift": ["-5 cm", 0, "10 cm"], "duration": "0.8 s"},
}
RUN = missions.toml(
    missions.phase("reach", REACH, duration="1 s", timeout="2 s"),
    robot={"model": "flapping.urdf", "joints": {"shoulder": "20 deg", "elbow": "60 deg"}},
    tasks=[missions.REST],
)


def test_a_hinge_without_a_drive_is_moved_by_the_others_alone(tmp_path):
    (tmp_path / "flapping.urdf").write_text(ROBOT)
    done = missions.flown(tmp_path, RUN)
    assert done.passed
    assert done.exceeded == {}
    assert set(done.phases[0].statuses) == {"nominal"}
    assert not any("hinge" in name for name in done.phases[0].active_limits)
    (segment,) = done.segments
    hinge = list(segment.robot.joint_names).index("hinge")
    assert (segment.trajectory.torque[:, hinge] == 0.0).all()
    assert np.abs(segment.trajectory.torque).max() > 0.1
    assert np.abs(segment.trajectory.v[:, 6 + hinge]).max() > 1e-4
