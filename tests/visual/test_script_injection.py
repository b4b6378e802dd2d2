"""Names from anywhere stay text in every page, whatever script they would be: its elements are those of plain names."""

import itertools
from html.parser import HTMLParser
from types import SimpleNamespace
from xml.sax.saxutils import quoteattr

import missions
import pytest
from urdf.corpus.parts import AXIS, LIMIT, inertial

from ospace.cli.main import main
from ospace.control import controller

PAYLOADS = (
    "<script>alert(1)</script>",
    "</script><script>alert(1)</script>",
    "<img src=x onerror=alert(1)>",
    '"><svg onload=alert(1)>',
    "' autofocus onfocus='alert(1)",
    "</title><script>alert(1)</script>",
    "</textarea><iframe srcdoc='<script>alert(1)</script>'>",
    "<!--<script>",
    "]]><script>alert(1)</script>",
    "&lt;script&gt;alert(1)&lt;/script&gt;",
    "{{ 7 * 7 }}{% for a in b %}",
    r"\u003c/script\u003e`+alert(1)+`",
)
"""To break out of an element's text, an attribute, a title, a comment, JSON, JavaScript's texts, and a template."""
PLAIN = tuple(f"plain {k}" for k in range(len(PAYLOADS)))


def urdf(names, *, sound=True):
    """Return an arm whose links and joints have the names, as have the robot, materials and meshes."""
    box = '<visual><geometry><box size="0.1 0.1 0.1"/></geometry><material name={0}><color rgba="1 0 0 1"/></material>'
    box += "</visual><visual><geometry><mesh filename={0}/></geometry></visual>"
    odd = [quoteattr(name) for name in names]
    parts, parent = [f"<link name='base'>{inertial()}</link>"], "'base'"
    for name in odd:
        body = inertial(moments=("1e-3", "2e-3", "9e-3")) if sound else ""
        parts.append(f"<link name={name}>{body}{box.format(name)}</link>")
        parts.append(
            f"<joint name={name} type='revolute'><parent link={parent}/><child link={name}/>"
            f"<origin xyz='0.3 0 0'/>{AXIS}{LIMIT}</joint>"
        )
        parent = name
    return f"<robot name={odd[0]}>{''.join(parts)}</robot>"


def scenario(names):
    """Return a scenario whose title, phases, tasks, target and frames have the names."""
    tasks = [{"name": name, "type": "position", "point": name, "goal": {"hold": True}} for name in names]
    return missions.toml(
        *(missions.phase(name, task, duration="2 ms", timeout="1 s") for name, task in zip(names, tasks, strict=True)),
        name=names[0],
        robot={"model": "odd.urdf"},
        target={"body": {"mass": 50, "inertia": [3, 4, 5], "name": names[1]}, "position": [9, 9, 9]},
    )


class Elements(HTMLParser):
    """Elements of a page in their order, each with the names of its attributes."""

    def __init__(self, page):
        super().__init__(convert_charrefs=True)
        self.found = []
        self.feed(page)

    def handle_starttag(self, tag, attributes):
        if tag not in ("g", "use", "path"):  # of which curves have as many as there are ticks
            self.found.append((tag, *(name for name, _ in attributes)))


def check(folder):
    return ["check", folder / "odd.urdf", "--samples", "1"]


def view(folder):
    return ["view", folder / "odd.urdf", "--layers", "robot,points,mass-centre"]


def run(folder):
    return ["run", folder / "odd.toml", "--headless"]


@pytest.fixture(autouse=True)
def every_cycle_takes_as_long(monkeypatch):
    """Curves of measured times differ from run to run, and so do the ticks of their axes."""
    ticks = itertools.count(0.0, 2.0**-17)  # differences are exact
    monkeypatch.setattr(controller, "clock", SimpleNamespace(perf_counter=ticks.__next__))


def made(folder, names, verb, *, sound=True):
    """Return the page that a verb writes about what has these names."""
    folder.mkdir()
    (folder / "odd.urdf").write_text(urdf(names, sound=sound))
    (folder / "odd.toml").write_text(scenario(names))
    page = folder / "page.html"
    assert main([*map(str, verb(folder)), "--html", str(page)]) in (0, 1)
    return page.read_text(encoding="utf-8")


@pytest.mark.parametrize(("verb", "sound"), [(check, True), (check, False), (view, True), (view, False), (run, True)])
def test_names_that_are_scripts_add_no_element_to_a_page(tmp_path, verb, sound):
    page = made(tmp_path / "odd", PAYLOADS, verb, sound=sound)
    assert Elements(page).found == Elements(made(tmp_path / "plain", PLAIN, verb, sound=sound)).found
    for payload in PAYLOADS[:9]:
        assert payload not in page
