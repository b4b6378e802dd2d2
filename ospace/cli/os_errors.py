"""Errors of the operating system in words: the file, what is wrong with it, and what would be right."""

from __future__ import annotations

import errno

_REMEDIES = {
    errno.ENOENT: "look at the path",
    errno.EACCES: "choose another place, or let yourself in by chmod",
    errno.EPERM: "choose another place, or let yourself in by chmod",
    errno.EROFS: "choose a folder that can be written",
    errno.ENOSPC: "make room, or choose another disk",
    errno.EDQUOT: "make room, or choose another disk",
    errno.EISDIR: "name a file in it",
    errno.ENOTDIR: "look at the path",
    errno.EEXIST: "choose another name",
    errno.ENAMETOOLONG: "choose a shorter name",
    errno.EMFILE: "raise the limit of open files, ulimit -n",
    errno.EADDRINUSE: "choose another --port",
    errno.ELOOP: "a link leads to itself: give the file it should lead to",
}


def text(error: OSError) -> str:
    """Return a line on an error of the operating system, without its number."""
    if error.errno is None or not error.strerror:
        return str(error)
    remedy = f"; {_REMEDIES[error.errno]}" if error.errno in _REMEDIES else ""
    return f"{'' if error.filename is None else f'{error.filename}: '}{error.strerror}{remedy}"
