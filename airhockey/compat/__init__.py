"""The package `air_hockey_challenge` of 2023, for submissions that were written for it.

    install()                  from now on, in this process, `import air_hockey_challenge` finds it
    build_entry(path, info)    build a submission's agent with it, and with what has changed in libraries since bridged

It is not on the path: `air_hockey_challenge/` beside this file is found only through the finder that `install` sets up. What
needs MushroomRL (extra `mushroom`) imports it when a submission asks for it, and not before.

finder.py       the import hook
own_copy.py     a submission's own copy of the package: what of it is used
bridges.py      names that NumPy, dataclasses and torch have dropped or changed since 2023
rl_info.py      `env_info["rl_info"]` as MushroomRL's own class
entries.py      building a submission's agent with all of this
"""

from airhockey.compat.entries import build_entry
from airhockey.compat.finder import install

__all__ = ["build_entry", "install"]
