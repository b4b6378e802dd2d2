"""Files made to exhaust a reader: each in a process of its own, which may take 3 s of its processor and 1 GB."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from urdf.corpus.parts import ARM, AXIS, joint, link, robot

import ospace

ROOT = Path(ospace.__file__).parents[1]
SECONDS, BYTES = 3.0, 1_000_000_000
PROGRAM = """
import re, sys, time
import ospace.model.robot, ospace.validation.report
from ospace.cli.main import main
before = time.process_time()
status = main(["check", sys.argv[1], "--json", "--samples", "1"])
seconds = time.process_time() - before
memory = 1024 * int(re.search(r"VmHWM:\\s+(\\d+) kB", open("/proc/self/status").read())[1])
print("measured", status, seconds, memory, file=sys.stderr)
"""
# VmHWM: ru_maxrss would count what the process held that started this one.

LAUGHS = "<!DOCTYPE robot [<!ENTITY a0 'aaaaaaaaaa'>" + "".join(
    f"<!ENTITY a{k + 1} '{f'&a{k};' * 10}'>" for k in range(12)
)
FIXED = '<joint name="j{0}" type="fixed"><parent link="l{1}"/><child link="l{0}"/></joint>'


def star(links):
    names = "".join(f'<link name="l{k}"/>' for k in range(links))
    return robot(names, *(FIXED.format(k, 0) for k in range(1, links)))


def chain(links, content=""):
    names = "".join(link(f"l{k}", content if k else None) for k in range(links))
    return robot(names, *(FIXED.format(k, k - 1) for k in range(1, links)))


def within(content):
    return ARM.replace("</robot>", content + "</robot>")


def arms(count):
    parts = (link(f"a{k}") + joint(f"h{k}", "continuous", "base", f"a{k}", AXIS) for k in range(count))
    return robot(link("base"), *parts)


SHAPES = '<visual><geometry><mesh filename="{0}.stl"/></geometry></visual>'
HOSTILE = {  # content, exit status, a word of what is said
    "billion laughs": (LAUGHS + "]>" + ARM.replace("made", "&a12;"), 2, "doctype"),
    "quadratic blow-up": (
        f"<!DOCTYPE r [<!ENTITY a '{'a' * 100_000}'>]><robot name='r'>{'&a;' * 50_000}",
        2,
        "doctype",
    ),
    "100 MB comment": (lambda: f"<!--{'x' * 100_000_000}-->" + ARM, 2, "too-large"),
    "19 MB comment": (lambda: within(f"<!--{'x' * 19_000_000}-->"), 2, "not-xml"),
    "9 MB comment": (lambda: within(f"<!--{'x' * 9_000_000}-->"), 0, "sound"),
    "19 MB of text": (lambda: within("x" * 19_000_000), 2, "not-xml"),
    "19 MB of a name": (lambda: ARM.replace('"arm"', '"' + "a" * 9_000_000 + '"'), 2, "too-long-attribute"),
    "19 MB of a tag": (lambda: within(f"<{'a' * 19_000_000}/>"), 2, "not-xml"),
    "19 MB of <": ("<" * 19_000_000, 2, "not-xml"),
    "200,000 attributes": (
        within("<a " + "".join(f'b{k}="" ' for k in range(200_000)) + "/>"),
        2,
        "too-many-attributes",
    ),
    "4 million attributes": (
        lambda: within(("<a " + "".join(f'b{k}="" ' for k in range(64)) + "/>") * 40_000),
        2,
        "too-many-nodes",
    ),
    "6 million elements": (lambda: within("<a/>" * 4_900_000), 2, "too-many-nodes"),
    "2 million comments": (lambda: within("<!---->" * 2_500_000), 2, "too-many-nodes"),
    "4 million instructions": (lambda: within("<?a?>" * 3_800_000), 2, "too-many-nodes"),
    "100,000-link star": (lambda: star(100_000), 2, "too-many-"),
    "20,000-link chain": (lambda: chain(20_000), 2, "too-many-links"),
    "20,000 joints": (lambda: robot(link("l0"), *(FIXED.format(k, 0) for k in range(1, 20_000))), 2, "too-many-links"),
    "100,000 deep": ("<robot name='r'>" + "<a>" * 100_000, 2, "too-deep"),
    "XML of 100,000 deep, closed": (
        "<robot name='r'>" + "<a>" * 100_000 + "</a>" * 100_000 + "</robot>",
        2,
        "too-deep",
    ),
    "2,000-link star": (star(2000).replace('<link name="l0"/>', link("l0")), 0, "sound"),
    "2,000-link chain": (chain(2000), 0, "sound"),
    "140 arms": (arms(140), 0, "sound"),
    "160 arms": (arms(160), 2, "too-many-dof"),
    "60,000 unknown elements": (
        within("").replace("</link>", "".join(f"<x{k}/>" for k in range(60_000)) + "</link>", 1),
        0,
        "unknown-element",
    ),
    "60,000 numbers that are none": (
        within("").replace(
            "</link>", '<visual><geometry><sphere radius="x"/></geometry></visual>' * 30_000 + "</link>", 1
        ),
        0,
        "visual-unreadable",
    ),
    "40,000 boxes": (
        within("").replace(
            "</link>", '<visual><geometry><box size="1 1 1"/></geometry></visual>' * 39_000 + "</link>", 1
        ),
        0,
        "sound",
    ),
    "30,000 meshes": (
        within("").replace("</link>", "".join(SHAPES.format(k) for k in range(30_000)) + "</link>", 1),
        0,
        "mesh-missing",
    ),
    "long names that are not found": (
        robot(*(link(f"{'a' * 9000}{k}") for k in range(1900)), joint(child="a" * 9000)),
        2,
        "unknown-link",
    ),
    "a number of 10,000 digits": (ARM.replace('value="2"', f'value="{"1" * 9_999}x"', 1), 1, "inertial-unreadable"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_no_file_takes_time_or_memory(tmp_path, name):
    content, status, word = HOSTILE[name]
    file = tmp_path / "robot.urdf"
    file.write_text(content() if callable(content) else content)
    finish(file, status, word)


def command(file):
    """Run the command in a process of its own, with compiled kernels."""
    compiled = {name: value for name, value in os.environ.items() if name != "NUMBA_DISABLE_JIT"}
    return subprocess.run(
        [sys.executable, "-c", PROGRAM, str(file)],
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
        env={**compiled, "PYTHONPATH": str(Path(ospace.__file__).parents[1])},
    )


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Kernels are compiled before time is taken."""
    command("target")


def finish(file, status, word):
    done = command(file)
    measured, there, seconds, memory = done.stderr.splitlines()[-1].split()
    assert (measured, int(there)) == ("measured", status), done.stderr[-2000:]
    assert float(seconds) < SECONDS
    assert float(memory) < BYTES
    assert word in done.stdout + done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/null", "/proc/self/mem", "/dev/tty"])
def test_a_device_is_answered_at_once(device):
    finish(Path(device), 2, "no-regular-file" if device != "/proc/self/mem" else "ospace: error")


def test_a_fifo_is_not_waited_for(tmp_path):
    file = tmp_path / "robot.urdf"
    os.mkfifo(file)
    finish(file, 2, "no-regular-file")


def test_a_mesh_that_is_a_fifo_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "arm.stl")
    file = tmp_path / "robot.urdf"
    file.write_text(ARM.replace("</link>", SHAPES.format("arm") + "</link>", 1))
    finish(file, 0, "mesh-unreadable")


# -- small stacks, threads, closed streams -----------------------------------------------------------------------


def fixed_chain(length):
    joints = (joint(f"j{k}", "fixed", f"l{k}", f"l{k + 1}") for k in range(length))
    return robot(*(link(f"l{k}") for k in range(length + 1)), *joints)


def test_a_thread_with_a_small_stack_reads_a_long_chain(tmp_path):
    """In a process of its own, as a stack that overflows ends the process."""
    file = tmp_path / "robot.urdf"
    file.write_text(fixed_chain(1000))
    program = (
        "import sys, threading, ospace\n"
        "ospace.SpaceRobot.from_urdf\n"
        "threading.stack_size(512 * 1024)\n"
        "thread = threading.Thread(target=lambda: print(ospace.SpaceRobot.from_urdf(sys.argv[1]).nv))\n"
        "thread.start(); thread.join()\n"
        "print(threading.stack_size())"
    )
    done = subprocess.run([sys.executable, "-c", program, str(file)], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, f"6\n{512 * 1024}\n"), done.stderr


def test_threads_leave_standard_error_where_it_was(tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(ARM)
    before = os.fstat(2)

    def read_often():
        for _ in range(30):
            ospace.SpaceRobot.from_urdf(file)

    threads = [threading.Thread(target=read_often) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert os.path.samestat(os.fstat(2), before)


@pytest.mark.parametrize(("redirection", "status"), [("2>&-", 0), (">&-", 2)])
def test_streams_that_the_caller_has_closed_stay_closed(tmp_path, redirection, status):
    file = tmp_path / "robot.urdf"
    file.write_text(ARM)
    command = f"exec '{sys.executable}' -m ospace.cli check '{file}' --samples 1 {redirection}"
    done = subprocess.run(["bash", "-c", command], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == status, done
    assert ("sound" in done.stdout) == (status == 0)
    assert ("cannot write the result" in done.stderr) == (status == 2)
