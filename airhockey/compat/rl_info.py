"""`env_info["rl_info"]` as MushroomRL's `MDPInfo`, which agents save, copy and build networks from."""

import sys
from typing import Any


def mdp_info(info: Any) -> Any:
    """Spaces and horizon as MushroomRL's own class; what is that already stays as it is."""
    from mushroom_rl.core import MDPInfo
    from mushroom_rl.utils.spaces import Box

    if isinstance(info, MDPInfo):
        return info
    seen, done = info.observation_space, info.action_space
    return MDPInfo(Box(seen.low, seen.high), Box(done.low, done.high), info.gamma, info.horizon, info.dt)


def settle(env_info: dict[str, Any]) -> None:
    """Make `rl_info` MushroomRL's where the code that was imported uses MushroomRL; nobody else pays for its import."""
    if "mushroom_rl.core" in sys.modules:
        env_info["rl_info"] = mdp_info(env_info["rl_info"])
