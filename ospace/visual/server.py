"""A scene served to browsers on this machine, as it changes."""

from __future__ import annotations

import asyncio
import errno
import os
import socket
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Self

from tornado.httpserver import HTTPServer
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from ospace.exceptions import OspaceError
from ospace.visual import page
from ospace.visual.page import Content

LOOPBACK = "127.0.0.1"
_LOOPBACKS = (LOOPBACK, "localhost", "::1", "[::1]")
PORT = 7000
_TRIES = 50  # ports from the first on, unless one is given


class Server:
    """Serves pages that show a scene and follow it, from a thread of its own; a context manager.

    Parameters
    ----------
    content : function
        Returns the content of the page, each time that one is opened.
    host : str
        Address to listen on: loopback, which this machine alone reaches, by default.
    port : int, optional
        The first free one from 7000 on without it.

    Raises
    ------
    OspaceError
        The address or port cannot be listened on.
    """

    def __init__(self, content: Callable[[], Content], host: str = LOOPBACK, port: int | None = None) -> None:
        self._content, self._scene = content, content().scene
        self._names = {*_LOOPBACKS, host} if host in _LOOPBACKS else set()  # elsewhere, who serves knows the names
        self._socket = _listen(host, port)
        self.port = int(self._socket.getsockname()[1])
        self.address = f"http://{f'[{host}]' if ':' in host else host}:{self.port}/"
        self._viewers: set[_Socket] = set()
        self._loop = asyncio.new_event_loop()
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="ospace scene server", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        self._ready.wait()
        self._scene.listen(self._changed)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._scene.forget(self._changed)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()

    @property
    def viewers(self) -> int:
        """Number of open pages."""
        return len(self._viewers)

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        shared = {"content": self._content, "viewers": self._viewers}
        application = Application(
            [("/", _Page, shared), ("/socket", _Socket, shared)], log_function=_no_log, names=self._names
        )
        server = HTTPServer(application)
        self._loop.call_soon(server.add_socket, self._socket)
        self._loop.call_soon(self._ready.set)
        try:
            self._loop.run_forever()
        finally:
            server.stop()
            for viewer in list(self._viewers):
                viewer.close()
            self._loop.run_until_complete(server.close_all_connections())
            self._loop.close()

    def _changed(self, command: bytes) -> None:
        self._loop.call_soon_threadsafe(self._send, command)

    def _send(self, command: bytes) -> None:
        for viewer in list(self._viewers):
            viewer.send(command)


class _Known(RequestHandler):
    """Answers to the names that it is served under alone: another's page would reach it by a name of its own."""

    def prepare(self) -> None:
        names = self.settings["names"]
        if names and self.request.host_name not in names:
            raise HTTPError(403, f"not served as {self.request.host_name}")


class _Page(_Known):
    def initialize(self, content: Callable[[], Content], viewers: set[_Socket]) -> None:
        self._make = content

    def get(self) -> None:
        self.set_header("Cache-Control", "no-store")
        self.finish(page.render(self._make(), live=self.request.host))


class _Socket(_Known, WebSocketHandler):
    def initialize(self, content: Callable[[], Content], viewers: set[_Socket]) -> None:
        self._make, self._viewers = content, viewers

    def open(self, *args: str, **more: str) -> None:
        for command in self._make().scene.commands():
            self.send(command)
        self._viewers.add(self)

    def on_message(self, message: str | bytes) -> None:
        """Ignore it: a page has nothing to say."""

    def on_close(self) -> None:
        self._viewers.discard(self)

    def send(self, command: bytes) -> None:
        """Send a command; a page that was closed meanwhile does not matter."""
        try:
            self.write_message(command, binary=True)
        except WebSocketClosedError:
            self._viewers.discard(self)


def _listen(host: str, port: int | None) -> socket.socket:
    tried = [port] if port is not None else [*range(PORT, PORT + _TRIES), 0]
    for one in tried:
        try:
            family = socket.getaddrinfo(host, one, type=socket.SOCK_STREAM)[0][0]
            listening = socket.create_server((host, one), family=family)
        except UnicodeError:
            reason = "no such host"
            break
        except OSError as error:
            unknown = isinstance(error, socket.gaierror)
            reason = str(error.strerror) if unknown else os.strerror(error.errno or 0)
            if error.errno != errno.EADDRINUSE:
                break  # another port would not help
        else:
            listening.setblocking(False)
            return listening
    raise OspaceError(f"cannot listen on {host}, port {tried[0]}: {reason}")


def _no_log(handler: RequestHandler) -> None:
    """Keep requests off the screen."""
