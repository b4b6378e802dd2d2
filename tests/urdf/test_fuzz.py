"""A small run of the fuzzer; docs/check.md has the record of a large one."""

from __future__ import annotations

import numpy as np
import pytest
from urdf import fuzz

from ospace.urdf.lint import inertia


@pytest.mark.parametrize("seed", range(4))
def test_mutated_files_are_refused_or_sound(tmp_path, capfd, seed):
    counts = fuzz.run(500, seed, tmp_path)
    assert counts.keys() == {"refused", "unsound", "robot"}
    assert counts["robot"] > 50
    assert capfd.readouterr() == ("", "")


def test_the_fuzzer_finds_a_reader_that_looks_away(tmp_path, monkeypatch):
    """Without the findings on inertias, robots with an indefinite H come through, and the fuzzer must see them."""
    monkeypatch.setattr(inertia, "check_bodies", lambda bodies, followers: [])
    with pytest.raises(AssertionError, match=r"indefinite|negative diagonal|not finite"):
        fuzz.run(2000, 0, tmp_path)


def test_mutated_files_differ():
    rng = np.random.default_rng(0)
    seeds = [variant.content for variant in fuzz.VARIANTS[:3]]
    assert len({fuzz.mutated(rng, seeds) for _ in range(100)}) > 80
