"""The package `air_hockey_challenge` of 2023, for submissions that were written for it.

    install()      from now on, in this process, `import air_hockey_challenge` finds it

It is not on the path: `air_hockey_challenge/` beside this file is found only through the finder that `install` sets up. What
needs MushroomRL (extra `mushroom`) imports it when a submission asks for it, and not before.
"""

from airhockey.compat.finder import install

__all__ = ["install"]
