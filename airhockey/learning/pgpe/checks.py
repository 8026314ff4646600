"""What can be said about a training's settings before anything is played."""

from airhockey.errors import ConfigurationError, unknown
from airhockey.learning.pgpe.records import Settings
from airhockey.learning.pgpe.stage import FIXED_STARTS, environments_of
from airhockey.learning.pgpe.trainable import bounds


def check(settings: Settings) -> None:
    """Find the mistakes in a run's settings; raises `ConfigurationError`."""
    environments_of(settings.task, settings.robot)
    if not 0.0 < settings.discount <= 1.0:
        raise ConfigurationError(f"the discount must be above 0 and at most 1, not {settings.discount:g}")
    if settings.discount == 1.0 and settings.reward == "thesis" and settings.task in ("hit", "switcher"):
        raise ConfigurationError("a goal is worth 1 / (1 - discount): the thesis's reward needs a discount below 1")
    if settings.fixed_start not in FIXED_STARTS:
        raise unknown("fixed start", settings.fixed_start, FIXED_STARTS)
    if settings.fixed_start != "none" and settings.task == "home":
        raise ConfigurationError(
            "on the way home the mallet is put somewhere, and the puck lies still: leave out --fixed-start"
        )
    if settings.candidates < 2:
        raise ConfigurationError(f"--candidates must be at least 2 to compare, not {settings.candidates}")
    if not settings.learning_rate > 0.0:
        raise ConfigurationError(f"the learning rate must be positive, not {settings.learning_rate:g}")
    if settings.max_penalty is not None and not settings.max_penalty >= 0.0:
        raise ConfigurationError(
            f"the penalty budget must be 0 or more points per episode, not {settings.max_penalty:g}"
        )
    for name in ("multiplier_rate", "sigma_share"):
        if not getattr(settings, name) >= 0.0:
            raise ConfigurationError(f"the {name.replace('_', ' ')} must be 0 or more, not {getattr(settings, name):g}")
    lower, upper = bounds(settings.names)
    for name, value, low, high in zip(settings.names, settings.mean, lower, upper, strict=True):
        if not low <= value <= high:
            raise ConfigurationError(f"{name} starts at {value:g}, but must be from {low:g} to {high:g}")
