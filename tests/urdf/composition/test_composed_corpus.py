"""Every odd file of the corpus as a part: refused by an `OspaceError`, or composed as sound as it is by itself."""

from __future__ import annotations

import numpy as np
import pytest
from urdf.corpus import VARIANTS
from urdf.fuzz import mutated

from ospace import OspaceError, Part, compose
from ospace.urdf import reader

BUS = "box:1x1x1m,9kg"
REFUSED_WITH_A_PREFIX = {"long name"}


@pytest.fixture
def part(tmp_path):
    return tmp_path / "part.urdf"


def read(path):
    try:
        return reader.read(path)
    except OspaceError:
        return None


def test_what_is_sound_by_itself_is_sound_on_a_bus(part):
    for variant in VARIANTS:
        part.write_bytes(variant.content)
        alone = read(part)
        if alone is None:
            with pytest.raises(OspaceError):
                compose(BUS, Part(part, prefix="p_"))
        elif variant.name not in REFUSED_WITH_A_PREFIX:
            composed = compose(BUS, Part(part, prefix="p_", at=(1, 0, 0), rpy=(0.1, 0.2, 0.3)))
            if alone.model is not None:
                assert not [one for one in composed.findings if one.severity == "error"], variant.name


def test_mutated_files_end_in_a_robot_or_a_refusal(part):
    rng, seeds = np.random.default_rng(5), [variant.content for variant in VARIANTS if variant.status == 0]
    ends = [0, 0]
    for _ in range(150):
        part.write_bytes(mutated(rng, seeds))
        try:
            compose(BUS, Part(part, prefix="p_"), Part(part, prefix="q_", at=(0, 0, 1)))
            ends[0] += 1
        except OspaceError:
            ends[1] += 1
    assert min(ends) > 0
