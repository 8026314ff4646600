"""What libraries have dropped or changed since 2023, given back to submissions: only where the old meaning is beyond doubt.

NumPy           aliases such as `np.float`, which NumPy 1.24 and 2.0 removed, mean what they meant
collections     `collections.Iterable` and the like, which moved to `collections.abc`
dataclasses     an array or another unhashable object as a field's default, refused since Python 3.11, is shared as it was
torch           `torch.load` maps what was saved on a GPU onto the CPU where there is none, and loads whole objects as it did

Not bridged, since no thin layer can: arrays of one entry as numbers (NumPy 2.4), OpenAI Gym, versions of libraries.
"""

import collections
import collections.abc
import dataclasses
import functools
import importlib.abc
import importlib.machinery
import importlib.util
import inspect
import sys
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import numpy as np

_NUMPY: dict[str, Any] = {
    "float": float, "int": int, "object": object, "str": str, "complex": complex, "long": int, "unicode": str, "bool": bool,
    "float_": np.float64, "complex_": np.complex128, "cfloat": np.complex128, "singlecomplex": np.complex64,
    "unicode_": np.str_, "string_": np.bytes_, "longfloat": np.longdouble,
    "Inf": np.inf, "infty": np.inf, "Infinity": np.inf, "PINF": np.inf, "NINF": -np.inf, "NaN": np.nan,
    "product": np.prod, "cumproduct": np.cumprod, "alltrue": np.all, "sometrue": np.any, "round_": np.round,
    "mat": np.asmatrix,
}  # fmt: skip
_MOVED = (
    "Callable",
    "Hashable",
    "Iterable",
    "Iterator",
    "Mapping",
    "MutableMapping",
    "MutableSequence",
    "Sequence",
    "Sized",
)
_MARK = "_airhockey_bridged"


def install() -> None:
    """Put up the bridges in this process. Twice is as good as once."""
    for name, meaning in {**_NUMPY, **_numpy_functions()}.items():
        if name not in vars(np):
            setattr(np, name, meaning)
    for name in _MOVED:
        if not hasattr(collections, name):
            setattr(collections, name, getattr(collections.abc, name))
    if sys.version_info >= (3, 11) and not hasattr(dataclasses.dataclass, _MARK):
        setattr(dataclasses, "dataclass", _with_shared_defaults(dataclasses.dataclass))  # noqa: B010 - mypy knows better
    if "torch" in sys.modules:
        _bridge_torch(sys.modules["torch"])
    elif not any(isinstance(finder, _AfterTorch) for finder in sys.meta_path):
        sys.meta_path.insert(0, _AfterTorch())


def _numpy_functions() -> dict[str, Any]:
    """Functions under another name, where this NumPy has that one."""
    new = {"in1d": "isin", "trapz": "trapezoid", "row_stack": "vstack", "asfarray": "asarray"}
    found = {old: getattr(np, name) for old, name in new.items() if hasattr(np, name)}
    return found | {"asfarray": functools.partial(np.asarray, dtype=np.float64), "asscalar": lambda array: array.item()}


def _with_shared_defaults(original: Callable[..., Any]) -> Callable[..., Any]:
    """`dataclass` that takes any default but a list, a dict or a set, as it did until 3.10; all else is the original's."""

    def decorate(cls: type, **options: Any) -> Any:
        fields = [name for name, kind in inspect.get_annotations(cls).items() if "ClassVar" not in str(kind)]
        shared = {name: vars(cls)[name] for name in fields if _refused(vars(cls).get(name))}
        for name, value in shared.items():
            setattr(cls, name, dataclasses.field(default_factory=functools.partial(_itself, value)))
        made = original(cls, **options)
        for name, value in shared.items():
            setattr(cls, name, value)
        return made

    @functools.wraps(original)
    def dataclass(cls: type | None = None, /, **options: Any) -> Any:
        return (lambda given: decorate(given, **options)) if cls is None else decorate(cls, **options)

    setattr(dataclass, _MARK, True)
    return dataclass


def _refused(default: Any) -> bool:
    """Whether Python 3.11 refuses a default that 3.10 took."""
    return type(default).__hash__ is None and not isinstance(default, (list, dict, set))


def _itself(value: Any) -> Any:
    return value


def _bridge_torch(torch: Any) -> None:
    original = torch.load
    if hasattr(original, _MARK):
        return

    @functools.wraps(original)
    def load(f: Any, map_location: Any = None, *args: Any, **kwargs: Any) -> Any:
        if map_location is None and not torch.cuda.is_available():
            map_location = "cpu"
        kwargs.setdefault("weights_only", False)
        return original(f, map_location, *args, **kwargs)

    setattr(load, _MARK, True)
    torch.load = load


class _AfterTorch(importlib.abc.MetaPathFinder):
    """Bridges torch once somebody has imported it."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if fullname != "torch":
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec("torch")
        if spec is not None and spec.loader is not None:
            loader, execute = spec.loader, spec.loader.exec_module

            def exec_module(module: ModuleType) -> None:
                execute(module)
                _bridge_torch(module)

            loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec
