"""Opens the way to a vehicle; all sockets and ports are ours to close."""

from __future__ import annotations

from groundstation.vehicle.network import TcpOut, UdpIn, UdpOut
from groundstation.vehicle.serial_port import SerialPort
from groundstation.vehicle.transport import Tell, Transport, Url


def open_transport(url: Url, tell: Tell = lambda _severity, _words: None) -> Transport:
    """Open the way to the vehicle.

    Args:
        url: Where it is.
        tell: Is told of a way that is lost and of one that is found again.

    Raises:
        TransportError: With where, why and what to do.
    """
    if url.scheme == "udpin":
        return UdpIn(url)
    if url.scheme == "udpout":
        return UdpOut(url)
    if url.scheme == "tcpout":
        return TcpOut(url, tell)
    return SerialPort(url, tell)
