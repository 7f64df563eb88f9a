"""A WebSocket client that never waits once it is connected (RFC 6455; `wsproto` does the protocol)."""

from __future__ import annotations

import select
import socket
import time
from importlib import import_module
from typing import TYPE_CHECKING

from drivers.device import DeviceError

if TYPE_CHECKING:
    from collections.abc import Iterator

    import wsproto

REMEDY = "pip install 'groundstation[inverse3]'"

_MOST_BYTES = 1 << 16


class WebSocket:
    """One connection.

    Args:
        host: Name or address.
        port: TCP port.
        patience: Longest that connecting may take, s.

    Raises:
        DeviceError: Nobody listens there, who does speaks no WebSocket, or the library is missing.
    """

    def __init__(self, host: str, port: int, patience: float) -> None:
        try:
            import_module("wsproto.events")  # takes longer than all that follows
        except ImportError as error:
            raise DeviceError(f"The package wsproto is missing; run: {REMEDY}") from error
        self._where = f"{host}:{port}"
        self._unsent = b""
        self._text = ""
        until = time.monotonic() + patience
        try:
            self._socket = socket.create_connection((host, port), timeout=patience)
        except OSError as error:
            raise DeviceError(
                f"{self._where}: no Inverse Service listens there ({error.strerror or error}); start it."
            ) from error
        try:
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._socket.settimeout(0.0)
            self._protocol = self._shake_hands(until)
        except BaseException:
            self._socket.close()
            raise

    def send(self, text: str) -> bool:
        """Send a message.

        Returns:
            False where the one before it is still on its way; this one is then not sent.

        Raises:
            DeviceError: The connection is gone.
        """
        from wsproto.events import TextMessage

        if not self._flush():
            return False
        self._push(self._protocol.send(TextMessage(text)))
        return True

    def receive(self) -> list[str]:
        """Return the messages that came since the last call.

        Raises:
            DeviceError: The connection is gone.
        """
        from wsproto.events import CloseConnection, Ping, TextMessage

        messages: list[str] = []
        for event in self._events():
            if isinstance(event, TextMessage):
                self._text += event.data
                if event.message_finished:
                    messages.append(self._text)
                    self._text = ""
            elif isinstance(event, Ping):
                self._push(self._protocol.send(event.response()))
            elif isinstance(event, CloseConnection):
                raise self._gone("it closed the connection")
        return messages

    def wait(self, seconds: float) -> None:
        """Wait until something comes; only for connecting."""
        select.select([self._socket], [], [], max(seconds, 0.0))

    def close(self) -> None:
        """Say good-bye as far as that needs no waiting, and let the socket go."""
        from wsproto.events import CloseConnection
        from wsproto.utilities import LocalProtocolError

        try:
            self._push(self._protocol.send(CloseConnection(code=1000)))
        except (DeviceError, LocalProtocolError):
            pass  # it is gone already
        finally:
            self._socket.close()

    def _shake_hands(self, until: float) -> wsproto.WSConnection:
        from wsproto import ConnectionType, WSConnection
        from wsproto.events import AcceptConnection, Request

        self._protocol = WSConnection(ConnectionType.CLIENT)
        self._push(self._protocol.send(Request(host=self._where, target="/")))
        while (left := until - time.monotonic()) > 0.0:
            self.wait(left)
            for event in self._events():
                if isinstance(event, AcceptConnection):
                    return self._protocol
                raise DeviceError(f"{self._where}: this is no Inverse Service; correct the address.")
        raise DeviceError(f"{self._where}: the Inverse Service does not answer; restart it.")

    def _events(self) -> Iterator[wsproto.events.Event]:
        """Yield what came, as the protocol understands it; first what an earlier reader left."""
        from wsproto.utilities import RemoteProtocolError

        try:
            yield from self._protocol.events()
            while data := self._received():
                self._protocol.receive_data(data)
                yield from self._protocol.events()
                if len(data) < _MOST_BYTES:
                    return
        except RemoteProtocolError as error:
            raise self._gone(f"what it sends is no WebSocket: {error}") from error

    def _received(self) -> bytes:
        try:
            data = self._socket.recv(_MOST_BYTES)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise self._gone(error.strerror or str(error)) from error
        if not data:
            raise self._gone("it closed the connection")
        return data

    def _push(self, data: bytes) -> None:
        self._unsent += data
        self._flush()

    def _flush(self) -> bool:
        if self._unsent:
            try:
                sent = self._socket.send(self._unsent)
            except BlockingIOError:
                return False
            except OSError as error:
                raise self._gone(error.strerror or str(error)) from error
            self._unsent = self._unsent[sent:]
        return not self._unsent

    def _gone(self, why: str) -> DeviceError:
        return DeviceError(f"{self._where}: the Inverse Service is gone ({why}); start it again.")
