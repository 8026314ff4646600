"""MuJoCo's web viewer under guard: it has no option for that."""

from collections.abc import Callable
from typing import Any

from mujoco.studio.web import web_server
from websockets.http11 import Request, Response

from airhockey.envs.rendering.guard import Guard

Process = Callable[[Any, Request], Any]
_guards: dict[int, Guard] = {}


def watch(guard: Guard, port: int) -> None:
    """Guard the viewer's server on this port, which is about to start."""
    _guards[port] = guard
    if web_server.serve is not _guarded_serve:
        web_server.serve = _guarded_serve


def _guarded_serve(
    handler: Any, *arguments: Any, process_request: Process, process_response: Any, sock: Any, **named: Any
) -> Any:
    """As `serve` of websockets, with the guard of the socket's port before everything else."""
    guard = _guards[sock.getsockname()[1]]

    def process(connection: Any, request: Request) -> Any:
        refused = guard.refused(request)
        if refused is not None:
            return refused
        response = process_request(connection, request)
        if isinstance(response, Response):
            guard.remember(request, response)
        return response

    def respond(connection: Any, request: Request, response: Response) -> Any:
        replaced = process_response(connection, request, response) or response
        while "Access-Control-Allow-Origin" in replaced.headers:
            del replaced.headers["Access-Control-Allow-Origin"]
        return replaced

    return _serve(handler, *arguments, process_request=process, process_response=respond, sock=sock, **named)


_serve = web_server.serve
