"""Expands one xacro, as a process of its own: a request comes from standard input, the result goes to standard output.

The expressions of a xacro are Python. What they may do is bounded before the first line of the file is read: time,
memory and output by limits of the operating system, and all else by an audit hook, which lets files in the folders
given be read and refuses every other thing that Python reports: other files, writing, processes, imports, sockets. No
environment variable is there.

Nothing of ospace is imported: the process is to start fast, and to hold little.
"""

from __future__ import annotations

import contextlib
import encodings.cp1252
import encodings.iso8859_15
import encodings.latin_1  # noqa: F401  # codecs that XML may declare: none can be imported later
import io
import json
import os
import re
import resource
import stat
import sys
from collections.abc import Iterator
from types import CodeType
from typing import Any, NoReturn
from xml.dom import Node, expatbuilder
from xml.parsers import expat

_LISTINGS = {"os.scandir", "os.listdir"}
_PATTERNS = {"glob.glob", "glob.glob/2"}
_HARMLESS = {"compile", "exec", "builtins.id", "sys._getframe", "sys.unraisablehook"}
_ORIGIN = "origin"  # key of an element's file and line
_MOST_MACROS = 5  # that a message names
_PACKAGE_XML = 100_000  # bytes


class _RefusedError(Exception):
    """The file is wrong, or wants what it may not have: reason, code of the refusal, and file and line where known."""

    def __str__(self) -> str:
        return str(self.args[0])


class _Gate:
    """The audit hook, and what it refused first."""

    def __init__(self, folders: list[str]) -> None:
        self.refused: _RefusedError | None = None
        self._folders = folders
        self._closed = False

    def close(self) -> None:
        self._closed = True
        sys.addaudithook(self)

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        if event in _HARMLESS:
            return
        if event == "open" and self._is_inside(arguments[0]) and not _writes(arguments):
            return
        if event in _LISTINGS and self._is_inside(arguments[0]):
            return
        if event in _PATTERNS and self._is_inside(os.path.dirname(re.split(r"[*?[]", str(arguments[0]))[0])):
            return
        self._refuse(event, arguments)

    def _refuse(self, event: str, arguments: tuple[Any, ...]) -> NoReturn:
        what = f"does what no robot needs ({event})"
        if (event == "open" and not _writes(arguments)) or event in _LISTINGS | _PATTERNS:
            what = f"reads '{os.path.realpath(str(arguments[0]))}', outside the file's package and package_dirs=[DIR]"
        refused = _RefusedError(what, "xacro-outside")
        self.refused = self.refused or refused
        raise refused

    def _is_inside(self, path: Any) -> bool:
        if isinstance(path, int):  # what is open already
            return True
        if not isinstance(path, str):
            return False
        real = os.path.realpath(path)
        return any(os.path.commonpath([folder, real]) == folder for folder in self._folders)


def _writes(arguments: tuple[Any, ...]) -> bool:
    _, mode, flags = (*arguments, None, None)[:3]
    if isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND):
        return True
    return isinstance(mode, str) and bool(set(mode) & set("wax+"))


# -- elements that know where they come from ---------------------------------------------------------------------------


class _Copied:
    """Hands file and line of an element on to its copies, of which a macro makes many."""

    def handle(self, operation: int, key: str, origin: Any, source: Any, copy: Any) -> None:
        if copy is not None:
            copy.setUserData(key, origin, self)


_COPIED = _Copied()


class _Builder(expatbuilder.ExpatBuilderNS):  # type: ignore[misc, unused-ignore]
    """Builds a document whose elements know their file and line; a document type is refused."""

    def __init__(self, file: str) -> None:
        super().__init__()
        self._file = file

    def start_element_handler(self, name: str, attributes: list[str]) -> None:
        super().start_element_handler(name, attributes)
        line = self.getParser().CurrentLineNumber
        self.curNode.setUserData(_ORIGIN, (self._file, line), _COPIED)

    def start_doctype_decl_handler(self, *arguments: Any) -> NoReturn:
        raise _RefusedError(f"'{self._file}' has a document type declaration: remove it", "doctype")


class _Expansion:
    """The library xacro, made to read in bounds and to say where it is."""

    def __init__(self, request: dict[str, Any]) -> None:
        import xacro
        import yaml  # noqa: F401  # which xacro imports when it needs it, and then could not
        from xacro import substitution_args

        self._xacro = xacro
        self._request = request
        self.latest: Any = None
        self.files: list[str] = []
        xacro.parse = self._parse
        for name in ("eval_all", "handle_macro_call", "grab_property", "grab_macro", "process_include", "check_attrs"):
            setattr(xacro, name, self._noting(getattr(xacro, name)))
        xacro.safe_eval = self._evaluate
        substitution_args._eval_find = self._find
        substitution_args.eval = self._evaluate_argument

    def run(self) -> tuple[str, list[tuple[int, int]]]:
        """Expand; return the text, and for each of its elements the number of its file, and its line there."""
        path = self._request["path"]
        self._xacro.init_stacks(path)
        self._xacro.substitution_args_context["filename"] = path
        document = self._parse(None, path)
        self._xacro.process_doc(document, mappings=dict(self._request["arguments"]))
        number = {file: k for k, file in enumerate(self.files)}
        origins = []
        for element in _elements(document.documentElement):
            file, line = element.getUserData(_ORIGIN) or (path, 1)
            origins.append((number.get(file, 0), line))
        return document.toprettyxml(indent="  "), origins

    def macros(self) -> list[str]:
        """Name the macros that are being expanded, the innermost first."""
        return [macro.body.getAttribute("name") for macro in reversed(self._xacro.macrostack or [])]

    def place(self) -> tuple[str, int | None]:
        """Return file and line of the element that was looked at last."""
        origin = None if self.latest is None else self.latest.getUserData(_ORIGIN)
        return origin or ((self._xacro.filestack or [self._request["path"]])[-1], None)

    def _noting(self, function: Any) -> Any:
        def noting(element: Any, *arguments: Any) -> Any:
            if element.getUserData(_ORIGIN) is not None:
                self.latest = element
            return function(element, *arguments)

        return noting

    def _parse(self, content: Any, path: str) -> Any:
        """Read a file, in place of `xacro.parse`."""
        try:
            descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
            with open(descriptor, "rb") as file:
                status = os.fstat(descriptor)
                if not stat.S_ISREG(status.st_mode):
                    raise OSError(0, "is not a regular file", path)
                if status.st_size > self._request["bytes"]:
                    raise _RefusedError(f"'{path}' has {status.st_size} bytes (limits=Limits(bytes=N))", "too-large")
                text = file.read(status.st_size)
        except OSError as error:
            self._xacro.filestack.pop()
            raise self._xacro.XacroException(f"'{path}' cannot be read: {error.strerror}", exc=error) from None
        if path not in self.files:
            self.files.append(path)
        try:
            return _Builder(path).parseString(text)
        except expat.ExpatError as error:
            reason = f"is not well-formed XML: {expat.errors.messages[error.code]}"
            raise _RefusedError(reason, "xacro-failed", path, error.lineno) from None

    def _find(self, package: str) -> str:
        """Return the folder of a package, for ``$(find package)``."""
        choices = [os.path.join(folder, package) for folder in self._request["package_dirs"]]
        choices = [choice for choice in choices if os.path.isdir(choice)]
        choices += [folder for folder in self._request["folders"] if _is_package(folder, package)]
        if package in ("", ".", "..") or "/" in package or not choices:
            reason = f"package '{package}' is not found: give the folder that holds it with package_dirs=[DIR]"
            raise _RefusedError(reason, "xacro-package")
        return choices[0]

    def _evaluate(self, expression: str, names: dict[str, Any], more: Any = None) -> Any:
        """Evaluate ``${…}``, in place of `xacro.safe_eval`."""
        names.update(__builtins__={})
        return eval(_compiled(expression), names, more)

    def _evaluate_argument(self, expression: str, names: dict[str, Any], more: Any) -> Any:
        """Evaluate ``$(eval …)``, which would have all of Python's built-in functions."""
        return eval(_compiled(expression), {"__builtins__": {}}, more)


def _compiled(expression: str) -> CodeType:
    code = compile(expression.strip(), "<expression>", "eval")
    for name in _names(code):
        if name.startswith("__"):
            raise _RefusedError(f"the expression '{expression}' uses the name '{name}'", "xacro-outside")
    return code


def _names(code: CodeType) -> Iterator[str]:
    yield from code.co_names
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _names(constant)


def _is_package(folder: str, package: str) -> bool:
    """Return whether a folder is a package of that name: by its package.xml, or else by its own name."""
    description = os.path.join(folder, "package.xml")
    if os.path.isfile(description):
        with open(description, "rb") as file:
            named = re.search(rb"<name>\s*([^<\s]+)\s*</name>", file.read(_PACKAGE_XML))
        if named is not None:
            return named[1].decode(errors="replace") == package
    return os.path.basename(folder) == package


def _elements(element: Any) -> Iterator[Any]:
    yield element
    waiting = [iter(element.childNodes)]
    while waiting:
        for child in waiting[-1]:
            if child.nodeType == Node.ELEMENT_NODE:
                yield child
                waiting.append(iter(child.childNodes))
                break
        else:
            waiting.pop()


def _lines(text: bytes) -> list[int]:
    """Return the line of each element."""
    lines: list[int] = []
    parser = expat.ParserCreate("utf-8")
    parser.StartElementHandler = lambda name, attributes: lines.append(parser.CurrentLineNumber)
    parser.Parse(text, True)
    return lines


def _limit(request: dict[str, Any]) -> None:
    """Have the operating system end what takes too much; where it does not know a limit, it is left out."""
    for what, size in (
        (resource.RLIMIT_CPU, request["seconds"] + 1),
        (resource.RLIMIT_AS, request["memory"]),
        (resource.RLIMIT_FSIZE, 4 * request["bytes"] + _PACKAGE_XML),
        (resource.RLIMIT_CORE, 0),
    ):
        with contextlib.suppress(ValueError, OSError):
            resource.setrlimit(what, (size, size))


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """Return an error, and those that it stands for."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        yield error
        error = getattr(error, "exc", None) or error.__cause__ or error.__context__


def _reason(causes: list[BaseException]) -> str:
    """Say what went wrong, without the names of Python's classes that xacro puts before it."""
    for cause in causes:
        text = " ".join(str(cause).split())
        if type(cause).__name__ == "ArgException":
            return f"argument '{text}' has no value: give {text}:=VALUE"
        if type(cause).__name__ == "SubstitutionException" and "environment variable" in text:
            return f"{text}: environment variables are not read, give the value in an argument"
    said = [" ".join(_said(cause).split()) for cause in causes]
    return next((text for text in said if text and not text.startswith("<class")), type(causes[0]).__name__)


def _said(error: BaseException) -> str:
    """Return the text of an error; one of xacro also tells the cause, which its own text may hold already."""
    own, cause = (str(error.args[0]) if error.args and error.args[0] else ""), str(getattr(error, "exc", None) or "")
    if not hasattr(error, "suffix"):
        return str(error)
    return " ".join([own if own and not own.startswith("<class") else cause, str(error.suffix or "")])


def _failure(error: Exception, expansion: _Expansion | None, gate: _Gate) -> dict[str, Any]:
    """Say what went wrong, and where."""
    causes = list(_causes(error))
    refused = gate.refused or next((cause for cause in causes if isinstance(cause, _RefusedError)), None)
    path, line = (None, None) if expansion is None else expansion.place()
    reason, code = _reason(causes), "xacro-failed"
    if refused is not None:
        reason, code, *where = refused.args
        path, line = where or (path, line)
    elif any(isinstance(cause, MemoryError) for cause in causes):
        reason, code = "takes more memory to expand than it may (limits=Limits(memory=N))", "xacro-exhausted"
    elif any(isinstance(cause, RecursionError) for cause in causes):
        reason, code = "its macros, includes or properties call each other without end", "xacro-exhausted"
    macros = [] if expansion is None else list(dict.fromkeys(expansion.macros()))[:_MOST_MACROS]
    return {"error": reason, "code": code, "path": path, "line": line, "macros": macros}


def main() -> None:
    """Answer one request."""
    request = json.loads(sys.stdin.buffer.read())
    _limit(request)
    sys.path += request["libraries"]
    printed = io.StringIO()
    sys.stdout = sys.stderr = printed  # xacro warns there, and expressions may print
    gate, expansion = _Gate(request["folders"]), None
    text = b""
    try:
        expansion = _Expansion(request)
        gate.close()
        expanded, origins = expansion.run()
        text = expanded.encode()
        if len(text) > request["bytes"]:
            most = f"at most {request['bytes']} are read (limits=Limits(bytes=N))"
            raise _RefusedError(f"expands to {len(text)} bytes; {most}", "too-large")
        warnings = [
            line.removeprefix("warning: ") for line in printed.getvalue().splitlines() if line.startswith("warning: ")
        ]
        answer: dict[str, Any] = {
            "files": expansion.files,
            "lines": list(zip(_lines(text), origins, strict=True)),
            "warnings": warnings,
        }
    except MemoryError:
        answer, text = _failure(MemoryError(), None, gate), b""
    except Exception as error:
        answer, text = _failure(error, expansion, gate), b""
    whole = json.dumps(answer).encode() + b"\n" + text
    while whole:
        whole = whole[os.write(1, whole) :]
    os._exit(0)  # the hook stays to the end, and would refuse what Python does at its exit


if __name__ == "__main__":
    main()
