"""Who may talk to the web viewer: whoever was given its address with the token in it, from a page of the viewer's own.

A browser sends requests to this machine on behalf of any page that it shows. So the first request has to bring the token, later
ones a cookie that only the viewer's own page sends; the name of the host must be this machine's, and the page's origin its own.
"""

import hmac
import ipaddress
import secrets
import urllib.parse
from collections.abc import Callable
from http.cookies import CookieError, SimpleCookie
from typing import Any

from mujoco.studio.web import web_server
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

Process = Callable[[Any, Request], Any]
_guards: dict[int, "Guard"] = {}


class Guard:
    """Of one viewer.

    Args:
        host: That it listens on.

    Attributes:
        token: What the address has to bring.
    """

    def __init__(self, host: str) -> None:
        self.token = secrets.token_urlsafe(24)
        self._host = host

    def watch(self, port: int) -> None:
        """Guard the server on this port, which is about to start."""
        self._cookie = f"hockey-{port}"
        _guards[port] = self
        if web_server.serve is not _guarded_serve:
            web_server.serve = _guarded_serve

    def refusal(self, target: str, headers: Headers) -> str | None:
        """Why a request is not answered; None if it is."""
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        if len(hosts) != 1 or not self._is_ours(hosts[0]):
            return "this host is not the viewer's"
        if any(origin not in (f"http://{hosts[0]}", f"https://{hosts[0]}") for origin in origins):
            return "this page is not the viewer's"
        if not (self.brings_token(target) or self._brings_cookie(headers)):
            return "open the address that hockey printed, token and all"
        return None

    def brings_token(self, target: str) -> bool:
        """Whether a request's address holds the token."""
        query = urllib.parse.parse_qs(urllib.parse.urlsplit(target).query)
        return any(hmac.compare_digest(given.encode(), self.token.encode()) for given in query.get("token", ()))

    @property
    def set_cookie(self) -> str:
        """The header that makes a browser remember the token, for the viewer's own page alone."""
        return f"{self._cookie}={self.token}; HttpOnly; SameSite=Strict; Path=/"

    def _brings_cookie(self, headers: Headers) -> bool:
        for line in headers.get_all("Cookie"):
            try:
                morsel = SimpleCookie(line).get(self._cookie)
            except CookieError:
                continue
            if morsel is not None and hmac.compare_digest(morsel.value.encode(), self.token.encode()):
                return True
        return False

    def _is_ours(self, host: str) -> bool:
        """Whether it is a name that only this machine's owner gives: an address, localhost, or what was asked for."""
        name = urllib.parse.urlsplit(f"//{host}").hostname or ""
        try:
            ipaddress.ip_address(name)
        except ValueError:
            return name in ("localhost", self._host.lower())
        return True


def _guarded_serve(
    handler: Any, *arguments: Any, process_request: Process, process_response: Any, sock: Any, **named: Any
) -> Any:
    """As `serve` of websockets, with the guard of the socket's port before everything else."""
    guard = _guards[sock.getsockname()[1]]

    def process(connection: Any, request: Request) -> Any:
        why = guard.refusal(request.path, request.headers)
        if why is not None:
            body = f"{why}\n".encode()
            headers = Headers({"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))})
            return Response(403, "Forbidden", headers, body)
        response = process_request(connection, request)
        if isinstance(response, Response) and guard.brings_token(request.path):
            response.headers["Set-Cookie"] = guard.set_cookie
        return response

    def respond(connection: Any, request: Request, response: Response) -> Any:
        replaced = process_response(connection, request, response) or response
        while "Access-Control-Allow-Origin" in replaced.headers:
            del replaced.headers["Access-Control-Allow-Origin"]
        return replaced

    return _serve(handler, *arguments, process_request=process, process_response=respond, sock=sock, **named)


_serve = web_server.serve
