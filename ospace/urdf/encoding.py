"""From the bytes of a file to its text, in the encoding that it has."""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass
from pathlib import Path

from ospace.urdf.errors import UrdfError

_MAGIC = {
    b"\x1f\x8b": "is compressed with gzip",
    b"PK\x03\x04": "is a zip archive",
    b"BZh": "is compressed with bzip2",
    b"\xfd7zXZ": "is compressed with xz",
    b"\xff\xfe\0\0": "is UTF-32 text",
    b"\0\0\xfe\xff": "is UTF-32 text",
    b"<\x00": "is UTF-16 text without a byte order mark",
    b"\x00<": "is UTF-16 text without a byte order mark",
}
_UTF_16 = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}
_DECLARATION = re.compile(r"\ufeff?(?P<blank>[ \t\r\n]*)(?P<declaration><\?xml\s[^<>]*\?>)")
_HEAD = 10_000  # bytes in which an XML declaration stands
_ENCODING = re.compile(r"""\sencoding\s*=\s*["']([A-Za-z][A-Za-z0-9._-]*)["']""")
_READ_ENCODINGS = re.compile(
    r"ascii|iso8859-\d+|cp125\d|cp437|cp850|cp932|cp949|koi8-[rut]|mac-roman|gb2312|gbk|gb18030|"
    r"big5|euc_jp|euc_kr|shift_jis"
)
"""Python's names of the encodings that are read; in all of them a letter of ASCII is the same byte as in UTF-8."""


@dataclass(frozen=True)
class Text:
    """Content of a file, in UTF-8, line for line.

    Attributes
    ----------
    content : bytes
        Spaces stand in the place of an XML declaration that declares another encoding, or stands behind blank lines.
    head : str
        What stands there in the file, without the blank lines; a byte order mark may stand before it.
    blank : int
        Length of what stands there in `content`.
    encoding : str
        Python's name of the encoding of the file.
    is_declared_late : bool
        Whether blank lines stand before the XML declaration.
    """

    content: bytes
    head: str = ""
    blank: int = 0
    encoding: str = "utf-8"
    is_declared_late: bool = False

    def restored(self, content: bytes) -> bytes:
        """Return `content`, which may differ behind the declaration, in the encoding of the file."""
        return self.head.encode(self.encoding) + content[self.blank :].decode().encode(self.encoding)


def decode(path: Path, content: bytes) -> Text:
    """Read bytes as text: UTF-8 where they are, UTF-16 with its byte order mark, else in the encoding that is declared.

    Returns
    -------
    Text

    Raises
    ------
    UrdfError
        The content is not text, or in an encoding that is not read.
    """
    for magic, what in _MAGIC.items():
        if content.startswith(magic):
            raise UrdfError(path, f"{what}: give a URDF in UTF-8", "not-text")
    encoding = _UTF_16.get(content[:2]) or "utf-8"
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError:
        encoding = _declared(path, content) if encoding == "utf-8" else encoding
        text = _decoded(path, content, encoding)
    where = text.find("\0")
    if where >= 0:
        raise UrdfError(path, "has a NUL byte: it is not text", "not-text", text.count("\n", 0, where) + 1)
    match = _DECLARATION.match(text)
    if encoding == "utf-8" and (match is None or not match["blank"]):
        return Text(content)
    mark, end = ("\ufeff", 1) if text.startswith("\ufeff") else ("", 0)
    head, late = mark, False
    if match is not None:
        head, late, end = mark + match["declaration"], bool(match["blank"]), match.end()
    blank = re.sub(r"[^\n]", " ", text[len(mark) : end])
    return Text((blank + text[end:]).encode(), head, len(blank), encoding, late)


def _decoded(path: Path, content: bytes, encoding: str) -> str:
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        what = f"has the byte 0x{content[error.start]:02x}, which is not {encoding.upper()}"
        reason = f"{what}: declare its encoding, as <?xml version='1.0' encoding='ISO-8859-1'?>, or convert the file"
        raise UrdfError(path, reason, "not-text", line) from None


def _declared(path: Path, content: bytes) -> str:
    """Return Python's name of the encoding that the XML declaration of a file names which is not UTF-8."""
    match = _DECLARATION.match(content[:_HEAD].decode("ascii", errors="replace"))
    named = None if match is None else _ENCODING.search(match["declaration"])
    if named is None:
        return "utf-8"
    try:
        encoding = codecs.lookup(named[1]).name
    except LookupError:
        encoding = named[1].lower()
    if encoding.startswith("utf"):
        return "utf-8"
    if not _READ_ENCODINGS.fullmatch(encoding):
        reason = f"declares the encoding '{named[1]}', which is not read: convert the file to UTF-8"
        raise UrdfError(path, reason, "not-text", 1)
    return encoding
