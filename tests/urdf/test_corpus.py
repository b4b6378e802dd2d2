"""Every file of the corpus gets the exit status and the codes that it must have, and nothing else is said."""

from __future__ import annotations

import json
import re

import pytest
from urdf.corpus import VARIANTS

from ospace.cli.main import main
from ospace.urdf.lint.rules import RULES

SAMPLED = {"smallest-inertia", "base-condition", "point-rank", "dynamic-singularity"}  # reported of every robot


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Kernels are compiled, and said to be, before messages are compared."""
    main(["check", "target", "--samples", "1"])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_corpus_is_large():
    assert len(VARIANTS) >= 150
    assert len({variant.name for variant in VARIANTS}) == len(VARIANTS)
    assert len({variant.content + repr(variant.options).encode() for variant in VARIANTS}) == len(VARIANTS)


@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: variant.name)
def test_a_variant_has_its_status_and_codes(folder, capfd, variant):
    file = folder / variant.file
    file.write_bytes(variant.content)
    status = main(["check", str(file), "--json", "--samples", "1", *variant.options])
    out, err = capfd.readouterr()
    assert status == variant.status, out + err
    if status == 2:
        assert out == ""
        assert err.startswith(f"ospace: error: {file}: ")
        assert err.count("\n") == 1
        assert set(re.findall(r"\[([a-z-]+)\]$", err.strip())) == variant.codes
        return
    assert err == ""
    findings = json.loads(out)["findings"]
    assert {one["code"] for one in findings if one["severity"] != "info"} == variant.codes, out
    assert {one["code"] for one in findings if one["severity"] == "info"} - SAMPLED == variant.infos
    assert any(one["severity"] == "error" for one in findings) == (status == 1)


BUILT_IN_CODE = {"inertia-not-finite"}
MACHINE = {"no-file", "no-regular-file", "unreadable-file", "too-many-nodes"}  # test_reader.py, test_hostile.py
NOT_KNOWN = {"rejected", "parity", "original-differs", "parser-error", "second-reader", "not-computable"}


def test_every_rule_has_a_variant():
    told = {code for variant in VARIANTS for code in variant.codes | variant.infos}
    assert RULES.keys() - told - SAMPLED == BUILT_IN_CODE | MACHINE | NOT_KNOWN
