"""What an agent in a process of its own can do wrong. Each is that agent's failure, and nobody else's."""

from airhockey.errors import AirHockeyError


class AgentError(AirHockeyError, RuntimeError):
    """An agent in another process failed; the message is one line."""


class AgentRaised(AgentError):
    """Its code raised; the message is what it raised, and where."""


class AgentDied(AgentError):
    """Its process ended."""


class AgentTimeout(AgentError):
    """It did not answer in time, and was stopped."""
