"""Settings that must hold before NumPy is loaded; and a run that more than one part looks at."""

import os

import pytest

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.pop("COLUMNS", None)  # which workers of xdist set: what is printed is broken at it


@pytest.fixture(scope="session")
def grasped():
    """Return the run of the scenario `grasp`, which takes seconds."""
    from ospace import models, scenario

    return scenario.run(scenario.load(models.scenario("grasp")))
