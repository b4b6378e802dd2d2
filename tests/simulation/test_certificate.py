"""The certificate: it fails where momentum is lost, and where a line of it cannot be computed."""

import dataclasses

import numpy as np
import pytest
import trees

from ospace.simulation import simulate


@pytest.fixture(scope="module")
def robot():
    return trees.tree(9, 8)


@pytest.fixture(scope="module")
def start(robot):
    state = trees.state(robot, 9)
    return state.q, 0.3 * state.v


def run(robot, state, controller=None, **options):
    return simulate(robot, *state, controller, **{"duration": 0.05, **options})


def test_certificate_fails_where_momentum_is_lost(robot, start):
    """Steps far too long for the motion: the certificate says so, and when it was worst."""
    result = simulate(robot, start[0], 20.0 * start[1], duration=0.2, step=0.02)
    certificate = result.certificate()
    assert not certificate.passed
    assert "FAIL (worst at" in str(certificate)


def test_the_certificate_of_a_robot_at_rest_passes(robot, start):
    certificate = run(robot, (start[0], np.zeros(robot.nv))).certificate()
    assert certificate.passed
    assert certificate["linear momentum"].error == 0.0


@pytest.fixture(scope="module")
def certified(robot, start):
    return simulate(robot, *start, duration=0.01)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("field", ["work", "kinetic_energy", "momentum", "impulse", "wheel_momentum", "dissipated"])
def test_a_line_that_cannot_be_computed_fails(certified, field, value):
    """In the last record alone: no line passes that the number enters, least of all by a scale without bound."""
    spoilt = getattr(certified, field).copy()
    spoilt[-1] = value
    certificate = dataclasses.replace(certified, **{field: spoilt}).certificate()
    assert not certificate.passed
    assert "FAIL (not computable at" in str(certificate)


@pytest.mark.parametrize("scale", ["total_mass", "largest_inertia"])
def test_a_scale_without_bound_fails(certified, scale):
    name = {"total_mass": "linear momentum", "largest_inertia": "angular momentum"}[scale]
    for value in (np.inf, np.nan):
        certificate = dataclasses.replace(certified, **{scale: value}).certificate()
        assert not certificate[name].passed
        assert certificate["work and energy"].passed
    assert certified.certificate().passed
