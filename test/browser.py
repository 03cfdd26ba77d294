"""A page in headless Chromium, driven over its DevTools protocol: a WebSocket with JSON."""

from __future__ import annotations

import base64
import json
import os
import shutil
import socket
import struct
import subprocess
import time
import urllib.request
from pathlib import Path
from typing import Any

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "google-chrome"))), None)
_PATIENCE = 60.0  # [s] wall


class Browser:
    """One page; a context manager that ends its browser."""

    def __init__(self, address: str, folder: Path) -> None:
        assert CHROMIUM is not None
        command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"]
        command += [f"--user-data-dir={folder}", "--remote-debugging-port=0", address]
        quiet = subprocess.DEVNULL
        self._process = subprocess.Popen(command, stdout=quiet, stderr=quiet)
        try:
            self._socket = self._connect(address.partition("#")[0], folder / "DevToolsActivePort")
        except BaseException:
            self._process.terminate()
            raise

    def __enter__(self) -> Browser:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()
        self._process.terminate()
        self._process.wait(_PATIENCE)

    def value(self, script: str) -> Any:
        """Value of a JavaScript expression in the page."""
        answer = self._command("Runtime.evaluate", expression=script, returnByValue=True)
        return answer["result"].get("value")

    def screenshot(self) -> bytes:
        """PNG of the page as it is now."""
        return base64.b64decode(self._command("Page.captureScreenshot")["data"])

    def until(self, script: str) -> None:
        """Wait until an expression is true."""
        deadline = time.monotonic() + _PATIENCE
        while not self.value(script):
            assert time.monotonic() < deadline, self.value("document.body.innerText")
            time.sleep(0.1)

    def move(self, slider: str, number: float, event: str) -> None:
        """Move a slider; `event` is `input` while it moves, `change` at its end."""
        self.value(
            f"(() => {{ const it = document.getElementById('{slider}'); it.value = {number};"
            f"it.dispatchEvent(new Event('{event}')); }})()"
        )

    def _command(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Result of a command of the protocol."""
        message = {"id": 1, "method": method, "params": parameters}
        self._send(json.dumps(message).encode())
        result: dict[str, Any] = json.loads(self._receive())["result"]
        return result

    def _connect(self, page: str, port_file: Path) -> socket.socket:
        deadline = time.monotonic() + _PATIENCE
        while not port_file.is_file() or not port_file.read_text(encoding="utf-8").strip():
            assert time.monotonic() < deadline, "the browser does not start"
            time.sleep(0.1)
        port = port_file.read_text(encoding="utf-8").split()[0]
        tabs: list[dict[str, str]] = []
        while not tabs:
            assert time.monotonic() < deadline, f"the browser does not open {page}"
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json") as answer:
                tabs = [tab for tab in json.load(answer) if tab["url"].startswith(page)]
        path = tabs[0]["webSocketDebuggerUrl"].split("/", 3)[3]
        connection = socket.create_connection(("127.0.0.1", int(port)), timeout=_PATIENCE)
        connection.sendall(
            f"GET /{path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n"
            "Sec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            head += connection.recv(1)
        assert b" 101 " in head, head
        return connection

    def _send(self, data: bytes) -> None:
        """One masked text frame (RFC 6455)."""
        mask = os.urandom(4)
        masked = bytes(byte ^ mask[k % 4] for k, byte in enumerate(data))
        size = (
            bytes([0x80 | len(data)])
            if len(data) < 126
            else b"\xfe" + struct.pack(">H", len(data))
        )
        self._socket.sendall(b"\x81" + size + mask + masked)

    def _receive(self) -> bytes:
        """The payload of one frame; DevTools does not split them."""
        size = self._exactly(2)[1]
        if size == 126:
            (size,) = struct.unpack(">H", self._exactly(2))
        elif size == 127:
            (size,) = struct.unpack(">Q", self._exactly(8))
        return self._exactly(size)

    def _exactly(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            part = self._socket.recv(count - len(data))
            assert part, "the browser ended"
            data += part
        return data
