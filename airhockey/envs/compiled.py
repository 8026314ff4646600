"""What other layers may use of the simulator's compiled code; the rest of `airhockey.envs.kernel` is its own affair.

Compiled functions of agents may call those of `chain`; `chain_sources` are the files that these are made of, which belong to
the fingerprint of their cache (`airhockey.envs.compiling`).
"""

import pathlib

from airhockey.envs import specs
from airhockey.envs.compiling import cache_folder, compiler, is_kept
from airhockey.envs.kernel import chain
from airhockey.envs.kernel.chain import SerialChain, forward_kinematics, point_jacobian
from airhockey.envs.kernel.constraints import MAX_END_EFFECTOR_Y, MIN_END_EFFECTOR_X
from airhockey.envs.kernel.kinematics import inverse_kinematics, work_space
from airhockey.envs.kernel.memory import pack, view

__all__ = [
    "MAX_END_EFFECTOR_Y",
    "MIN_END_EFFECTOR_X",
    "SerialChain",
    "cache_folder",
    "chain_sources",
    "compiler",
    "forward_kinematics",
    "inverse_kinematics",
    "is_kept",
    "pack",
    "point_jacobian",
    "view",
    "work_space",
]

chain_sources = (pathlib.Path(specs.__file__), pathlib.Path(chain.__file__))
"""Files of the functions of `chain`, and of the constants in them."""
