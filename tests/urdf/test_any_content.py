"""Any bytes, text, graph and numbers are answered: by a robot with a sound H, or by an error that says why not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from urdf import fuzz
from urdf.corpus.parts import ARM, LIMIT, inertial, joint, link, robot

pytestmark = pytest.mark.usefixtures("no_hang")
repeatable = settings(derandomize=True, deadline=None, max_examples=50)


def answer(folder, content):
    """Any content gives a robot whose H is finite and not indefinite, or an OspaceError that says why there is none."""
    file = folder / "any.urdf"
    file.write_bytes(content)
    assert fuzz.verdict(file, np.random.default_rng(0)) in ("robot", "refused", "unsound")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("any")


@repeatable
@given(content=st.binary(max_size=200))
def test_any_bytes_are_answered(folder, content):
    answer(folder, content)


@repeatable
@given(content=st.text(max_size=100))
def test_any_text_in_a_link_is_answered(folder, content):
    answer(folder, robot(link("base"), content).encode("utf-8", "replace"))


TOKENS = [
    "0",
    "-1",
    "1e400",
    "nan",
    "",
    '"',
    "<",
    ">",
    "/>",
    "<link/>",
    "&amp;",
    "&x;",
    "base",
    "arm",
    "fixed",
    "<joint/>",
]


@repeatable
@given(data=st.data())
def test_any_piece_replaced_in_a_sound_file_is_answered(folder, data):
    """A sound file, a piece taken out, and something put in its place."""
    start = data.draw(st.integers(0, len(ARM)))
    stop = data.draw(st.integers(start, min(len(ARM), start + 40)))
    answer(folder, (ARM[:start] + data.draw(st.sampled_from(TOKENS)) + ARM[stop:]).encode())


names = st.sampled_from(["base", "arm", "hand", "hinge"])
kinds = st.sampled_from(["revolute", "continuous", "prismatic", "fixed", "floating", "planar"])
any_joint = st.builds(joint, names, kinds, names, names)
any_link = st.builds(link, names, st.sampled_from([inertial(), "", "<inertial/>"]))


@repeatable
@given(links=st.lists(any_link, max_size=4), joints=st.lists(any_joint, max_size=4))
def test_any_graph_of_links_and_joints_is_answered(folder, links, joints):
    answer(folder, robot(*links, *joints).encode())


numbers = (
    st.floats().map(repr) | st.integers(-3, 3).map(str) | st.sampled_from(["1e-300", "1e300", " 1 ", "1,5", "0x1"])
)
triples = st.tuples(numbers, numbers, numbers)
any_inertial = st.builds(
    lambda mass, moments, products, origin: inertial(mass, moments, products, " ".join(origin)),
    numbers,
    triples,
    triples,
    triples,
)


@settings(repeatable, max_examples=200)
@given(base=any_inertial, arm=any_inertial, axis=triples, origin=triples, kind=kinds)
def test_any_numbers_are_answered(folder, base, arm, axis, origin, kind):
    more = f'<axis xyz="{" ".join(axis)}"/>' + LIMIT
    parts = link("base", base), link("arm", arm), joint(kind=kind, more=more, origin=" ".join(origin))
    answer(folder, robot(*parts).encode())


small = st.floats(-2.0, 2.0).map(repr)
moments = st.tuples(*[st.floats(-1e-9, 1.0).map(repr)] * 3)


@settings(repeatable, max_examples=200)
@given(
    inertials=st.lists(
        st.tuples(st.floats(0.0, 10.0).map(repr), moments, st.tuples(small, small, small)), min_size=3, max_size=3
    ),
    joints=st.tuples(kinds, kinds),
    axes=st.lists(st.tuples(small, small, small), min_size=2, max_size=2),
)
def test_any_numbers_of_a_usual_size_are_answered(folder, inertials, joints, axes):
    zero = ("0", "0", "0")
    links = [link(f"l{k}", inertial(m, i, zero, " ".join(c))) for k, (m, i, c) in enumerate(inertials)]
    hinges = [
        joint(f"j{k}", kind, f"l{k}", f"l{k + 1}", f'<axis xyz="{" ".join(axis)}"/>' + LIMIT)
        for k, (kind, axis) in enumerate(zip(joints, axes, strict=True))
    ]
    answer(folder, robot(*links, *hinges).encode())
