"""A policy's network played with NumPy: two hidden layers of rectified units, and tanh of the mean. No torch needed."""

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from airhockey.errors import ConfigurationError

Weights = NDArray[np.float32]

LARGEST_FILE = 500_000
"""Of a network's file, in bytes: more is not one of these."""


class Network:
    """Layers of a perceptron: x ← max(0, W x + b), and at the end tanh(W x + b)."""

    def __init__(self, layers: Mapping[str, Weights]) -> None:
        """Check and keep the weights.

        Args:
            layers: "weight_0", "bias_0", …: shapes (out, in) and (out,).

        Raises:
            ConfigurationError: The layers do not fit together, or a weight is not finite.
        """
        count = len(layers) // 2
        names = {f"{kind}_{k}" for k in range(count) for kind in ("weight", "bias")}
        if not count or set(layers) != names:
            raise ConfigurationError(f"a network has weight_0, bias_0, weight_1 and so on, not {sorted(layers)}")
        self._layers = [
            (np.asarray(layers[f"weight_{k}"], dtype=np.float32), np.asarray(layers[f"bias_{k}"], dtype=np.float32))
            for k in range(count)
        ]
        width = None
        for k, (weight, bias) in enumerate(self._layers):
            fits = weight.ndim == 2 and bias.shape == weight.shape[:1] and width in (None, weight.shape[1])
            if not fits or not (np.isfinite(weight).all() and np.isfinite(bias).all()):
                raise ConfigurationError(
                    f"layer {k} of shapes {weight.shape}, {bias.shape} does not fit or is not finite"
                )
            width = weight.shape[0]
        self.inputs, self.outputs = self._layers[0][0].shape[1], int(width or 0)

    @classmethod
    def load(cls, path: Path) -> "Network":
        """Read a network's file, without executing anything in it.

        Raises:
            ConfigurationError: It cannot be read, is too large, or holds something else.
        """
        try:
            if path.stat().st_size > LARGEST_FILE:
                raise ConfigurationError(f"{str(path)!r} has more than {LARGEST_FILE} bytes: not a skill's network")
            with np.load(path, allow_pickle=False) as file:
                return cls({name: file[name] for name in file.files})
        except (OSError, ValueError, AttributeError, zipfile.BadZipFile) as error:
            raise ConfigurationError(f"cannot read the network {str(path)!r}: {error}") from error

    def as_bytes(self) -> bytes:
        """The content of a file that `load` reads."""
        arrays: dict[str, Weights] = {}
        for k, (weight, bias) in enumerate(self._layers):
            arrays[f"weight_{k}"], arrays[f"bias_{k}"] = weight, bias
        content = io.BytesIO()
        np.savez_compressed(content, allow_pickle=False, **arrays)
        return content.getvalue()

    def __call__(self, features: Weights) -> Weights:
        """The action. Shapes (inputs,) → (outputs,), each entry in [−1, 1]."""
        x = features
        for weight, bias in self._layers[:-1]:
            x = np.maximum(weight @ x + bias, np.float32(0.0))
        weight, bias = self._layers[-1]
        action: Weights = np.tanh(weight @ x + bias)
        return action
