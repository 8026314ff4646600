"""What to say about a module that a submission imports and that is not there: whose fault it is, and what to do."""

import sys

from airhockey.agents.packaging.checkout import BUILDER, PACKAGE, Checkout
from airhockey.agents.packaging.unfetched import empty_submodule
from airhockey.errors import AirHockeyError, ConfigurationError, MissingDependencyError

CHALLENGE = "air_hockey_challenge"

# Packages that entries are known to import, by the names of their modules; what pip calls them where it differs.
_MUSHROOM = "'airhockey[mushroom]'"
_DISTRIBUTIONS = {
    **{
        name: name
        for name in (
            "absl-py", "casadi", "chex", "cloudpickle", "cma", "cpprb", "crocoddyl", "cvxopt", "cvxpy", "d3rlpy", "daqp", "deap",
            "dill", "dm_control", "einops", "elements", "filterpy", "flax", "gymnasium", "h5py", "imageio", "jax", "joblib",
            "lightning", "matplotlib", "mediapy", "moviepy", "mujoco", "networkx", "nevergrad", "nlopt", "numba", "numpy", "onnx",
            "onnxruntime", "optax", "optuna", "osqp", "pandas", "pettingzoo", "plotly", "proxsuite", "psutil", "pybullet",
            "pygame", "pyglet", "pygmo", "pyswarms", "qpsolvers", "quadprog", "ray", "ruckig", "sb3_contrib", "scipy", "scs",
            "seaborn", "shapely", "stable_baselines3", "sympy", "tensorboard", "tensorboardX", "tensorflow", "termcolor",
            "tianshou", "toppra", "torchrl", "tqdm", "transformers", "transforms3d", "trimesh", "wandb", "zmq",
        )
    },
    "PIL": "pillow",
    "absl": "absl-py",
    "cv2": "opencv-python-headless",
    "dm_env": "dm-env",
    "experiment_launcher": "experiment-launcher",
    "haiku": "dm-haiku",
    "hydra": "hydra-core",
    "mushroom_rl": _MUSHROOM,
    "omegaconf": "omegaconf",
    "pinocchio": "pin",
    "pydrake": "drake",
    "pytorch_lightning": "pytorch-lightning",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "tensordict": "tensordict",
    "torch": _MUSHROOM,
    "torchvision": "torchvision",
    "yaml": "pyyaml",
}  # fmt: skip


def missing_module(checkout: Checkout, error: ModuleNotFoundError) -> AirHockeyError:
    """The error to raise instead of a `ModuleNotFoundError` of the submission's code."""
    agent, full = f"the agent in {str(checkout.package)!r}", error.name or "?"
    name = full.partition(".")[0]
    if name == CHALLENGE:
        return MissingDependencyError(f"{agent} imports {full!r}, which the official package does not have either")
    if name == PACKAGE:
        return ConfigurationError(f"{agent} imports {full!r}, but has no such file")
    unfetched = empty_submodule(checkout.root, full)
    if unfetched is not None:
        return ConfigurationError(
            f"{agent} imports {full!r}, which is in the git submodule {unfetched!r}, whose folder is empty: git submodule "
            "update --init --recursive fetches it"
        )
    if "." in full and name in sys.modules:
        return _no_submodule(checkout, agent, full)
    place = checkout.has_module(name)
    if place is not None:
        return ConfigurationError(
            f"{agent} imports {name!r}, which lies at {str(place)!r} in it, where Python does not look: the import path is the "
            f"root and the folder of {BUILDER}; import it by its whole name, as in {'.'.join(place.with_suffix('').parts)!r}"
        )
    if name == "gym":
        return MissingDependencyError(
            f"{agent} imports 'gym', which is not installed: OpenAI Gym is given up, and does not work with NumPy 2; import "
            "gymnasium instead, or give the agent an interpreter that has gym (--python PATH)"
        )
    if name in _DISTRIBUTIONS:
        return MissingDependencyError(
            f"{agent} imports {name!r}, which is not installed: pip install {_DISTRIBUTIONS[name]}"
        )
    return ConfigurationError(
        f"{agent} imports {name!r}, which is neither a file of the submission nor a package known here: put it at the root, "
        "or, if it is a package, install it"
    )


def _no_submodule(checkout: Checkout, agent: str, full: str) -> AirHockeyError:
    """A package is there, the part of it that is imported is not."""
    name = full.partition(".")[0]
    version = getattr(sys.modules[name], "__version__", None)
    if checkout.has_module(name) is not None or (checkout.root / name).is_dir():
        return ConfigurationError(f"{agent} imports {full!r}, but has no such file")
    which = f"{name} {version}" if version else f"the installed {name}"
    return MissingDependencyError(
        f"{agent} imports {full!r}, which {which} does not have: it was written for another version; give it an interpreter of "
        "its own with that one (--python PATH)"
    )
