"""What the tests of scenarios share."""

from functools import partial

import missions
import pytest

from ospace.scenario import log


@pytest.fixture
def load(tmp_path):
    """Return what loads the text of a scenario, as from a file."""
    return partial(missions.loaded, tmp_path)


@pytest.fixture(scope="session")
def run(tmp_path_factory):
    made = missions.flown(tmp_path_factory.mktemp("mission"))
    assert made.passed, [phase.reason for phase in made.phases]
    assert len(made.segments) == 3
    return made


@pytest.fixture(scope="session")
def of_run(run):
    return log.of(run)
