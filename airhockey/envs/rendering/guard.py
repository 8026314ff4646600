"""Who may talk to a page of ours: whoever was given its address with the token in it, from the page's own script.

A browser sends requests to this machine on behalf of any page that it shows. So the first request has to bring the token, later
ones a cookie that only the page itself sends; the name of the host must be this machine's, and the page's origin its own.
"""

import hmac
import ipaddress
import secrets
import urllib.parse
from http.cookies import CookieError, SimpleCookie

from websockets.datastructures import Headers
from websockets.http11 import Request, Response


class Guard:
    """Of one server.

    Args:
        host, port: That it listens on.

    Attributes:
        token: What the address has to bring.
    """

    def __init__(self, host: str, port: int) -> None:
        self.token = secrets.token_urlsafe(24)
        self._host, self._cookie = host, f"hockey-{port}"

    def refused(self, request: Request) -> Response | None:
        """The answer to a request that is not to be answered otherwise; None where it is."""
        why = self.refusal(request.path, request.headers)
        return None if why is None else text_response(403, "Forbidden", f"{why}\n", "text/plain")

    def remember(self, request: Request, response: Response) -> None:
        """Let the browser that brought the token remember it."""
        if self.brings_token(request.path):
            response.headers["Set-Cookie"] = self.set_cookie

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
        """The header that makes a browser remember the token, for the page itself alone."""
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


def text_response(status: int, reason: str, body: str, kind: str, **headers: str) -> Response:
    """An answer of text; names of further headers have _ for -."""
    content = body.encode()
    fields = {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(content))}
    more = {name.replace("_", "-"): value for name, value in headers.items()}
    return Response(status, reason, Headers(fields | more), content)
