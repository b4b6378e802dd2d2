"""What the tests of scenarios share."""

from functools import partial

import missions
import pytest


@pytest.fixture
def load(tmp_path):
    """Return what loads the text of a scenario, as from a file."""
    return partial(missions.loaded, tmp_path)
