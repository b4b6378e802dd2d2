"""Remedies as the shell has them: errors and findings name arguments of Python, which are options here."""

from __future__ import annotations

import re

_OPTIONS = (
    (re.compile(r"limits=Limits\((\w+)=N\)"), r"--max-\1 N"),
    (re.compile(r"package_dirs=\[DIR\]"), "--package-dir DIR"),
    (re.compile(r"\bfree_mimic=True"), "--free-mimic"),
    (re.compile(r"\broot=('[^']*'|LINK\b)"), r"--root \1"),
    (re.compile(r"\bprefix='([^']*)'"), r"--prefix \1"),
)


def shell(text: str) -> str:
    """Return a text with the options of the command line in the place of arguments in Python."""
    for python, option in _OPTIONS:
        text = python.sub(option, text)
    return text
