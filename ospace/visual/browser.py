"""Pictures of a page, by a Chromium of this machine without a window."""

from __future__ import annotations

import base64
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from ospace.exceptions import OspaceError
from ospace.files import replacing

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
)
_TIME = 60.0  # s, for a picture
_VIRTUAL = 8000  # ms of the page's own time, in which it draws


def find() -> str:
    """Return the path of a Chromium.

    Raises
    ------
    OspaceError
        No Chromium is installed.
    """
    for name in NAMES:
        path = shutil.which(name)
        if path:
            return path
    raise OspaceError(
        "a picture or PDF needs Chromium, which was not found: install it (Debian: apt install chromium), "
        "or write the scene with --html and open it in any browser"
    )


def flags() -> list[str]:
    """Return the options that Chromium draws with: by processor, without a window, nothing fetched."""
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    return [*FLAGS, *(["--no-sandbox"] if root else [])]  # which Chromium refuses to root


def screenshot(page: str, path: Path, size: tuple[int, int] = (1000, 700), part: str = "") -> None:
    """Draw a page, as HTML, into a PNG file.

    Parameters
    ----------
    page : str
    path : Path
    size : (int, int)
        Pixels.
    part : str
        Fragment of the address, after ``#``: ``t=14.7`` is that time of an animation, ``bare`` the picture alone.

    Raises
    ------
    OspaceError
        Chromium is not installed, or draws nothing.
    """
    drawn = _drawn(page, "screenshot", ".png", part, f"--window-size={size[0]},{size[1]}")
    with replacing(path) as file:
        file.write_bytes(drawn)


def pdf(page: str, path: Path) -> None:
    """Print a report, as HTML, to a PDF file: with a picture in the place of the scene, and nothing folded.

    Parameters
    ----------
    page : str
    path : Path

    Raises
    ------
    OspaceError
        Chromium is not installed, or prints nothing.
    """
    still = base64.b64encode(_drawn(page, "screenshot", ".png", "bare", "--window-size=1400,700")).decode()
    picture = f'<img id="still" alt="the scene" src="data:image/png;base64,{still}"><section id="scene"'
    open_page = page.replace('<section id="scene"', picture, 1).replace("<details", "<details open")
    printed = _drawn(open_page, "print-to-pdf", ".pdf", "", "--no-pdf-header-footer")
    with replacing(path) as file:
        file.write_bytes(printed)


def _drawn(page: str, how: str, suffix: str, part: str, *options: str) -> bytes:
    """Return what Chromium makes of a page by one of its options."""
    chromium = find()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        source, made = Path(folder) / "page.html", Path(folder) / f"made{suffix}"
        source.write_text(page, encoding="utf-8")
        command = [
            chromium,
            "--headless",
            *flags(),
            *options,
            f"--user-data-dir={folder}/profile",
            f"--virtual-time-budget={_VIRTUAL}",
            f"--{how}={made}",
            f"{source.as_uri()}#{part}",
        ]
        try:
            ended = subprocess.run(command, capture_output=True, timeout=_TIME, check=False)
        except subprocess.TimeoutExpired:
            raise OspaceError(f"{chromium} drew no picture within {_TIME:g} s") from None
        if not made.is_file():
            said = ended.stderr.decode(errors="replace").strip().splitlines()
            raise OspaceError(f"{chromium} drew no picture: {said[-1] if said else f'exit status {ended.returncode}'}")
        return made.read_bytes()
