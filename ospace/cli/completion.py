"""``ospace completion SHELL``: what lets a shell complete verbs, options and files of ospace."""

from __future__ import annotations

import argparse
from typing import Any

PAGE = "command_line"
EXAMPLES = (
    "ospace completion bash > ~/.local/share/bash-completion/completions/ospace",
    'ospace completion zsh > "${fpath[1]}/_ospace"',
)
_SHELLS = ("bash", "zsh", "tcsh")
_FOLDERS = ("DIR",)
_FILES = ("URDF", "SCENARIO", "FILE", "OUT", "PNG", "LOG.npz", "LOG2.npz")


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    verb = verbs.add_parser(
        "completion",
        help="let a shell complete verbs, options and files",
        description="Print the script by which a shell completes verbs, options and files of ospace.",
    )
    verb.add_argument("shell", metavar="SHELL", choices=_SHELLS, help=", ".join(_SHELLS))
    verb.set_defaults(run=run)


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Return the exit status and the script."""
    import shtab

    from ospace.cli.main import parser, verbs_of

    top = parser()
    for verb in verbs_of(top).values():
        for action in verb._actions:
            if action.metavar in _FOLDERS:
                action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
            elif action.metavar in _FILES:
                action.complete = shtab.FILE  # type: ignore[attr-defined]
    return 0, shtab.complete(top, given.shell) + "\n"
