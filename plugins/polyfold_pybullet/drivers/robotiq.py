"""Robotiq's two-finger hands, through the text protocol of their URCap at a UR controller (port 63352)."""

from __future__ import annotations

import socket
import time

from polyfold.errors import RobotError

PORT = 63352
SHUT = 255
"""Position that means shut; 0 is open."""
MOVING = 0
"""What ``OBJ`` is while the fingers move; 1 and 2 are stopped by something, 3 is where it was told to go."""


class RobotiqHand:
    """One hand.

    Args:
        host: the controller's address.
        stroke: how wide the open hand is [m].
        port: of the URCap.
        patience: how long an answer or a movement may take [s].
    """

    def __init__(self, host: str, stroke: float, port: int = PORT, patience: float = 5.0) -> None:
        self._where = f"the hand at {host}:{port}"
        self._address, self._stroke, self._patience = (host, port), stroke, patience
        self._socket: socket.socket | None = None

    def connect(self) -> None:
        """Open the connection; the hand must have been activated, which moves it. Raises RobotError otherwise."""
        try:
            self._socket = socket.create_connection(self._address, self._patience)
        except OSError as error:
            raise RobotError(
                f"{self._where} does not answer ({error}); check the address, and that its URCap is installed"
            ) from error
        if self._get("STA") != 3:
            self.close()
            raise RobotError(f"{self._where} is not activated; activate it at the pendant, which moves its fingers")

    def close(self) -> None:
        """Close the connection."""
        if self._socket is not None:
            self._socket.close()
        self._socket = None

    def grip(self, closed: bool) -> float:
        """Close or open it, wait until the fingers rest, and say how wide it is then [m]."""
        wanted = SHUT if closed else 0
        # Where to is said before that it shall go: another place may have been left over.
        self._tell(POS=wanted, SPE=128, FOR=60)
        self._tell(GTO=1)
        until = time.monotonic() + self._patience
        # The hand takes over what it was asked for a moment later; until then it says that it has arrived.
        while self._get("PRE") != wanted or self._get("OBJ") == MOVING:
            if time.monotonic() > until:
                raise RobotError(f"{self._where} does not come to rest; look at its fingers")
            time.sleep(0.02)
        if fault := self._get("FLT"):
            raise RobotError(f"{self._where} reports the fault {fault}; look it up in its manual, and activate it anew")
        return self._stroke * (1.0 - self._get("POS") / SHUT)

    def _tell(self, **values: int) -> None:
        said = self._ask("SET " + " ".join(f"{name} {value}" for name, value in values.items()))
        if said != "ack":
            raise RobotError(f"{self._where} answered {said!r}; restart its URCap")

    def _get(self, name: str) -> int:
        said = self._ask(f"GET {name}")
        try:
            return int(said.removeprefix(name))
        except ValueError as error:
            raise RobotError(f"{self._where} answered {said!r}; restart its URCap") from error

    def _ask(self, line: str) -> str:
        if self._socket is None:
            raise RobotError(f"{self._where} is not connected; call connect first")
        try:
            self._socket.sendall(f"{line}\n".encode("ascii"))
            said = self._socket.recv(1024)
        except OSError as error:
            raise RobotError(f"{self._where} does not answer ({error}); check its connection") from error
        if not said:
            raise RobotError(f"{self._where} has closed the connection; is the controller on?")
        return said.decode("ascii", "replace").strip()
