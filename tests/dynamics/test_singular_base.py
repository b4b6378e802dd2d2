"""A base without inertia about some axis, or none beside what it carries, is refused by every way in, not computed."""

from __future__ import annotations

import warnings

import numpy as np
import pinocchio as pin
import pytest
from exact import exact
from urdf.corpus.parts import LIMIT, inertial, joint, link, robot

import ospace
from ospace.control import Controller, PostureTask
from ospace.validation import report

FLAT = ("0", "0", "0.3")
IN_LINE = float(np.arctan2(0.2, 0.3))


@pytest.fixture
def planar(tmp_path):
    """A planar arm of two joints, of which the file gives izz alone: in line, nothing resists a turn about it."""
    up = '<axis xyz="0 0 1"/>' + LIMIT
    file = tmp_path / "planar.urdf"
    file.write_text(
        robot(
            *(link(name, inertial("2", FLAT, origin=place)) for name, place in LINKS.items()),
            joint(more=up, origin="0.3 0.2 0"),
            joint("elbow", "revolute", "arm", "fore", up, "0.8 0 0"),
        )
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return ospace.SpaceRobot.from_urdf(file)


LINKS = {"base": "0 0 0", "arm": "0.4 0 0", "fore": "0.4 0 0"}


def light_base(mass, kind=pin.JointModelRX):
    """A base under an arm of a tonne; all else equal, so that the ratio of masses is what counts."""
    model = pin.Model()
    body = pin.Inertia(1.0, np.array([0.1, 0.2, -0.1]), np.diag([0.02, 0.03, 0.04]))
    base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    model.appendBodyToJoint(base, pin.Inertia(mass, body.lever, mass * body.inertia), pin.SE3.Identity())
    above = base
    for k, scale in enumerate((1e3, 0.5e3)):
        placed = pin.SE3(pin.exp3(np.array([0.3, 0.5 * k, 0.2])), np.array([0.3, -0.1, 0.2]))
        above = model.addJoint(above, kind(), placed, f"joint_{k}")
        model.appendBodyToJoint(above, pin.Inertia(scale, body.lever, scale * body.inertia), pin.SE3.Identity())
        model.addFrame(pin.Frame(f"tip_{k}", above, pin.SE3.Identity(), pin.FrameType.OP_FRAME))
    return ospace.SpaceRobot.from_model(model)


def ways_in(made, state, point):
    yield "operational_space", lambda: ospace.operational_space(state, [point])
    yield "free_floating", lambda: ospace.free_floating(state, [point])
    yield "generalized_jacobian", lambda: ospace.generalized_jacobian(state, [point])
    yield "generalized_dynamics", lambda: ospace.generalized_dynamics(state)
    controller = Controller(made, [PostureTask(name="posture")])
    yield "controller", lambda: controller.update(0.0, state.q.copy(), state.v.copy())
    for quantities in (("inertia_inverse",), ("generalized_inertia",), ("inertia", "generalized_jacobian")):
        evaluator = ospace.OperationalSpaceEvaluator(made, [point], quantities)
        yield f"evaluator of {quantities}", lambda one=evaluator: one.update(state.q.copy(), state.v.copy())


@pytest.mark.parametrize("off", [0.0, 1e-9, -1e-8])
def test_masses_in_line_are_refused(planar, off):
    q = planar.configuration({"hinge": IN_LINE + off, "elbow": 0.0})
    state, point = planar.state(q, np.full(8, 0.1)), planar.point("fore", axes="linear")
    for name, call in ways_in(planar, state, point):
        with pytest.raises(ospace.SingularInertiaError, match="base") as caught:
            call()
        assert caught.value.joint is None, name
    batch = ospace.operational_space_batch(planar, [point], state.q[None], state.v[None], ("inertia",))
    assert batch.bad.tolist() == [0]
    assert not batch.inertia.any()


def test_masses_off_their_line_are_computed(planar):
    q = planar.configuration({"hinge": IN_LINE, "elbow": 0.4})
    state, point = planar.state(q, np.full(8, 0.1)), planar.point("fore", axes="linear")
    for _, call in ways_in(planar, state, point):
        call()
    found = ospace.operational_space(state, [planar.point("fore")]).inertia_inverse
    wanted = exact(state, [planar.point("fore")]).inertia_inverse
    np.testing.assert_allclose(found, wanted, rtol=1e-10, atol=1e-10 * np.abs(wanted).max())


@pytest.mark.parametrize("kind", [pin.JointModelRX, pin.JointModelPZ])
def test_a_base_that_is_lost_beside_its_arm_is_refused(kind):
    made = light_base(1e-12, kind)
    rng = np.random.default_rng(0)
    q = pin.integrate(made.model, made.neutral(), rng.uniform(-1.0, 1.0, made.nv))
    state, point = made.state(q, rng.normal(size=made.nv)), made.point("tip_1", axes="linear")
    for name, call in ways_in(made, state, point):
        if name != "generalized_jacobian":  # which is known to the last digits of J_m, however light the base
            with pytest.raises(ospace.SingularInertiaError, match="base"):
                call()


@pytest.mark.parametrize("mass", [1e-3, 1e-5, 1e-8])
def test_a_light_base_is_computed_to_the_digits_that_are_left(mass):
    made = light_base(mass)
    rng = np.random.default_rng(0)
    q = pin.integrate(made.model, made.neutral(), rng.uniform(-1.0, 1.0, made.nv))
    state, points = made.state(q, rng.normal(size=made.nv)), [made.point("tip_1")]
    found, wanted = ospace.operational_space(state, points).inertia_inverse, exact(state, points).inertia_inverse
    scale = np.sqrt(np.diag(wanted))
    error = np.abs((found - wanted) / np.outer(scale, scale)).max()
    assert error < 1e-15 * (1e3 / mass) + 1e-13


def test_the_check_says_that_it_is_the_base(tmp_path):
    file = tmp_path / "one.urdf"
    file.write_text(
        robot(
            link("base", inertial("2", FLAT, origin="0 0 0")),
            link("arm", inertial("2", FLAT, origin="0.4 0 0")),
            joint(more='<axis xyz="0 0 1"/>' + LIMIT, origin="0.3 0 0"),
        )
    )
    made = ospace.SpaceRobot.from_urdf(file)
    checked = report.check(made, [made.point("arm")], samples=1)
    (finding,) = (one for one in checked.findings if one.severity == "error")
    assert (finding.code, finding.subject) == ("singular-inertia", "link 'base'")
    assert "--fix" in finding.remedy
