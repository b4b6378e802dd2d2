"""Ctrl-C, acted on where that is safe, and never lost.

Python raises KeyboardInterrupt wherever it happens to be. An import then leaves modules half made, and some extension
modules crash; libraries swallow it, or make another error of it, or leave files open; finalizers print it. So it is
raised only while all that runs is ospace and the standard library. Anywhere else the handler looks again every few
milliseconds: it waits for the end of an import however long that takes, and for other work of libraries, which may
compile or draw for long, up to a second.
"""

from __future__ import annotations

import signal
import sys
import time as clock
from types import CodeType, FrameType, TracebackType
from typing import Any, Self

_AGAIN = 0.01  # s until the handler looks again
_PATIENCE = 1.0  # s
_IMPORTS = frozenset(("importlib", "_frozen_importlib", "_frozen_importlib_external", "zipimport"))
_SAFE = frozenset(("ospace", "__main__", *sys.stdlib_module_names)) - _IMPORTS - {"weakref", "_weakrefset"}
"""Packages that an exception may leave at any line; callbacks of weak references would print it."""


class Interrupts:
    """Holds SIGINT while a verb runs; a context manager.

    Parameters
    ----------
    below : code object
        Of the function that the verb runs in: what called it, such as a test, does not count.
    """

    def __init__(self, below: CodeType) -> None:
        self._below = below
        self._since: float | None = None
        self._timed = hasattr(signal, "setitimer")  # not on Windows
        self._before: dict[signal.Signals, Any] = {}

    @property
    def seen(self) -> bool:
        """Return whether the user has interrupted."""
        return self._since is not None

    def refuse(self) -> None:
        """Raise `KeyboardInterrupt` where the user has interrupted."""
        if self.seen:
            self._look_again_in(0.0)
            raise KeyboardInterrupt

    def clear(self) -> None:
        """Forget an interrupt that was meant to end what went before."""
        if self.seen:
            self._look_again_in(0.0)
            self._since = None

    def __enter__(self) -> Self:
        numbers = (signal.SIGINT, signal.SIGALRM) if self._timed else (signal.SIGINT,)
        try:
            self._before = {number: signal.signal(number, self._handle) for number in numbers}
        except ValueError:  # not the main thread, which alone is interrupted
            return self
        self._hook, sys.unraisablehook = sys.unraisablehook, self._unraisable
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._before:
            return
        if self.seen:
            self._look_again_in(0.0)
        sys.unraisablehook = self._hook
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self._since is None:
            if number != signal.SIGINT:  # cleared meanwhile
                return
            self._since = clock.monotonic()
        running = self._running(frame)
        late = not self._timed or clock.monotonic() - self._since > _PATIENCE
        if running <= _SAFE or (late and not running & _IMPORTS):
            raise KeyboardInterrupt
        self._look_again_in(_AGAIN)

    def _running(self, frame: FrameType | None) -> set[str]:
        """Return the packages of the functions that run, innermost first, up to that of the verb."""
        packages = set()
        while frame is not None and frame.f_code is not self._below:
            packages.add(str(frame.f_globals.get("__name__")).partition(".")[0])
            frame = frame.f_back
        return packages

    def _look_again_in(self, seconds: float) -> None:
        """Call the handler once more; in 0 s means never."""
        if self._timed:
            signal.setitimer(signal.ITIMER_REAL, seconds)

    def _unraisable(self, ignored: sys.UnraisableHookArgs) -> None:
        """Keep finalizers quiet once the user has interrupted, and raise again what one of them swallowed."""
        if self._since is None:
            self._hook(ignored)
        elif issubclass(ignored.exc_type, KeyboardInterrupt):
            self._look_again_in(_AGAIN)
