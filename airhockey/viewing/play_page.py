"""The page on which a person plays: the table from above, the mallet led by mouse or finger, score and clock.

It is one file without anything from elsewhere, served under guard. What there is to see goes out over a WebSocket at every
control step; where the person points comes back on it.
"""

import dataclasses
import json
import secrets
import threading
from collections.abc import Callable
from importlib import resources
from types import TracebackType
from typing import Any, Self, cast

from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import Server, ServerConnection, serve

from airhockey.agents.person import Hand, Seen
from airhockey.envs.rendering.guard import Guard, text_response
from airhockey.envs.specs import CONTROL_PERIOD, MALLET, PUCK, TABLE
from airhockey.errors import ConfigurationError
from airhockey.evaluator.engines.engine import InProcess
from airhockey.evaluator.engines.pool import Pool
from airhockey.evaluator.play.game import GamePlayer
from airhockey.evaluator.runs.game_records import Status

_LONGEST_MESSAGE = 256
_FIRST_PORT, _PORTS = 8090, 20
_QUIET = 0.5
"""Time after which the page is told of what has not changed, in [s]."""


class PlayPage:
    """Serves the page while the block runs.

    Args:
        hand: Shared with the player.
        host: To listen on.
        port: 0 for the first free one from 8090.

    Attributes:
        address: Of the page, token and all.

    Raises:
        ConfigurationError: The address cannot be listened on.
    """

    def __init__(self, hand: Hand, host: str, port: int) -> None:
        self._hand = hand
        self._status: Status | None = None
        self._over: str | None = None
        self._somebody = threading.Event()
        self._server = self._listen(host, port)
        bound = self._server.socket.getsockname()[1]
        self._guard = Guard(host, bound)
        self.address = f"http://{f'[{host}]' if ':' in host else host}:{bound}/?token={self._guard.token}"

    def _listen(self, host: str, port: int) -> Server:
        error: OSError | None = None
        for one in [port] if port else range(_FIRST_PORT, _FIRST_PORT + _PORTS):
            try:
                return serve(self._talk, host, one, process_request=self._answer, max_size=_LONGEST_MESSAGE)
            except OSError as failure:
                error = failure
        assert error is not None
        raise ConfigurationError(f"cannot listen on {host}:{port or _FIRST_PORT}: {error.strerror or error}") from error

    def __enter__(self) -> Self:
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        return self

    def __exit__(self, _: type[BaseException] | None, __: BaseException | None, ___: TracebackType | None) -> None:
        self._server.shutdown()

    def wait_for_person(self) -> None:
        """Until somebody points at the table; Ctrl-C ends it."""
        while not self._somebody.wait(0.2):
            pass

    def show(self, status: Status) -> None:
        """How the game stands."""
        self._status = status

    def end(self, why: str) -> None:
        """The game is over; the page says so."""
        self._over = why

    def _answer(self, _: ServerConnection, request: Request) -> Response | None:
        """Let in the page's own WebSocket, and give the page to who brings the token."""
        refused = self._guard.refused(request)
        if refused is not None:
            return refused
        path = request.path.partition("?")[0]
        if path == "/play":
            return None
        if path != "/":
            return text_response(404, "Not Found", "there is nothing here\n", "text/plain")
        nonce = secrets.token_urlsafe(16)
        policy = (
            f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; connect-src 'self'; "
            "base-uri 'none'; form-action 'none'"
        )
        response = text_response(200, "OK", _page(nonce), "text/html", Content_Security_Policy=policy)
        self._guard.remember(request, response)
        return response

    def _talk(self, connection: ServerConnection) -> None:
        """To one browser: its pointer in this thread, what there is to see in another."""
        threading.Thread(target=self._tell, args=(connection,), daemon=True).start()
        try:
            for message in connection:
                self._take(message)
        except ConnectionClosed:
            pass
        finally:
            self._hand.release()

    def _take(self, message: str | bytes) -> None:
        """A place as [x, y], or null; anything else is not listened to."""
        try:
            place = json.loads(message)
        except (ValueError, RecursionError):
            return
        if place is None:
            self._hand.release()
        elif isinstance(place, list) and len(place) == 2 and all(_is_number(value) for value in place):
            self._hand.point(float(place[0]), float(place[1]))
            self._somebody.set()

    def _tell(self, connection: ServerConnection) -> None:
        number = 0
        try:
            while True:
                number, seen = self._hand.wait(number, _QUIET)
                connection.send(json.dumps(self._told(seen)))
        except ConnectionClosed:
            return

    def _told(self, seen: Seen | None) -> dict[str, Any]:
        told: dict[str, Any] = {"over": self._over}
        if seen is not None:
            told |= {
                "step": seen.step,
                "puck": _place(seen.puck),
                "mallet": _place(seen.mallet),
                "target": _place(seen.target),
            }
            told["opponent"] = None if seen.opponent is None else _place(seen.opponent)
        status = self._status
        if status is not None:
            told |= {"score": status.score, "faults": status.faults}
            told["left"] = round((status.steps - status.step) * CONTROL_PERIOD, 1)
        return told


class Shown(InProcess):
    """Plays games in this process, and tells of every control step.

    Args:
        on_step: Called with how the game stands.
    """

    def __init__(self, on_step: Callable[[Status], None]) -> None:
        self._on_step = on_step

    def pool(self, function: Callable[[Any], Any]) -> Pool[Any, Any]:
        """See `InProcess.pool`; the function is a `GamePlayer`."""
        return super().pool(dataclasses.replace(cast(GamePlayer, function), on_step=self._on_step, every=1))


def _page(nonce: str) -> str:
    text = resources.files("airhockey.viewing").joinpath("play.html").read_text(encoding="utf-8")
    sizes = {
        "length": TABLE.length, "width": TABLE.width, "goal": TABLE.goal_width, "puck": PUCK.radius, "mallet": MALLET.radius
    }  # fmt: skip
    return text.replace("{{nonce}}", nonce).replace("{{sizes}}", json.dumps(sizes))


def _place(point: Any) -> list[float]:
    return [round(float(value), 4) for value in point]


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e6
