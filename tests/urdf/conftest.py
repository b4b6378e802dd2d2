"""A guard against readers that wait for ever."""

from __future__ import annotations

import signal

import pytest

SECONDS = 300  # a reader that waits, waits for ever; one that is traced on a busy machine is slow


@pytest.fixture
def no_hang():
    """Fail a test that waits for a file, a network or an expansion for ever."""

    def give_up(number, frame):
        raise TimeoutError(f"no answer in {SECONDS} s")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(SECONDS)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
