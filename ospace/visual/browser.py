"""Pictures of a page, by a Chromium of this machine without a window."""

from __future__ import annotations

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
        "a screenshot needs Chromium, which was not found: install it (Debian: apt install chromium), "
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
    chromium = find()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        source, picture = Path(folder) / "page.html", Path(folder) / "page.png"
        source.write_text(page, encoding="utf-8")
        command = [
            chromium,
            "--headless",
            *flags(),
            f"--user-data-dir={folder}/profile",
            f"--window-size={size[0]},{size[1]}",
            f"--virtual-time-budget={_VIRTUAL}",
            f"--screenshot={picture}",
            f"{source.as_uri()}#{part}",
        ]
        try:
            ended = subprocess.run(command, capture_output=True, timeout=_TIME, check=False)
        except subprocess.TimeoutExpired:
            raise OspaceError(f"{chromium} drew no picture within {_TIME:g} s") from None
        if not picture.is_file():
            said = ended.stderr.decode(errors="replace").strip().splitlines()
            raise OspaceError(f"{chromium} drew no picture: {said[-1] if said else f'exit status {ended.returncode}'}")
        with replacing(path) as drawn:
            shutil.copyfile(picture, drawn)
