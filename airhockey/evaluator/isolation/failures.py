"""What an agent can do wrong, and how it is said. Each is that agent's failure, and nobody else's."""

import contextlib
import signal
import sys
import traceback

from airhockey.errors import AirHockeyError


class AgentError(AirHockeyError, RuntimeError):
    """An agent in another process failed; the message is one line."""


class AgentRaised(AgentError):
    """Its code raised; the message is what it raised, and where."""


class AgentDied(AgentError):
    """Its process ended."""


class AgentTimeout(AgentError):
    """It did not answer in time, and was stopped."""


def agent_failures() -> tuple[type[BaseException], ...]:
    """What counts as the agent's failure when its code is called, for an `except`, of what was just raised: everything.

    But a KeyboardInterrupt is the user's, unless this process ignores the user's: then only the agent can have raised it.
    """
    is_the_users = isinstance(sys.exc_info()[1], KeyboardInterrupt)
    ignored = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    return (Exception,) if is_the_users and not ignored else (BaseException,)


def describe(failure: BaseException) -> str:
    """One line: the kind of error, what it says, and for an error that is not ours the file and line."""
    try:
        text = " ".join(str(failure).split())[:300]
    except BaseException:
        text = "its text cannot be had: it raises"
    if isinstance(failure, AgentRaised):
        return text  # described where it was raised
    place = ""
    if not isinstance(failure, AirHockeyError):
        with contextlib.suppress(IndexError):
            frame = traceback.extract_tb(failure.__traceback__)[-1]
            place = f" ({frame.filename.rsplit('/', 1)[-1]}:{frame.lineno})"
    return f"{type(failure).__name__}: {text}{place}" if text else f"{type(failure).__name__}{place}"
