"""The errors that airhockey raises, and how they read.

A message names the value, what was allowed, and what to do about it; the command line prints it as one line. Every class
below derives from `AirHockeyError`, so that a caller can catch all of ours and nothing else.
"""

import difflib
from collections.abc import Iterable


class AirHockeyError(Exception):
    """Base of every error that this package raises on purpose."""


class ConfigurationError(AirHockeyError, ValueError):
    """A name, a number or a file that the user gave is not usable (exit status 2 on the command line)."""


class ActionError(AirHockeyError, ValueError):
    """An agent's action has the wrong shape or type, or is not finite. The engine has not seen it."""


class SimulationError(AirHockeyError, RuntimeError):
    """The physics engine warned (diverged, ran out of memory …); the message names the control step."""


class EnvironmentFault(AirHockeyError, RuntimeError):
    """The environment, its disturbances or this machine failed: no agent has a part in it (exit status 4)."""


class MissingDependencyError(AirHockeyError, ImportError):
    """An optional package is not installed; the message gives the command that installs it."""


def unknown(kind: str, value: object, allowed: Iterable[str]) -> ConfigurationError:
    """A `ConfigurationError` for a name that is not one of those allowed, with the nearest one as a hint.

    Args:
        kind: What the name stands for, for example "task".
        value: What was given.
        allowed: The names that would have worked.
    """
    names = sorted(allowed)
    near = difflib.get_close_matches(str(value), names, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    return ConfigurationError(f"unknown {kind} {value!r}; allowed: {', '.join(names)}.{hint}")
