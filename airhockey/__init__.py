"""airhockey: an open laboratory for robot air hockey.

The layers, top to bottom: `cli` and `commands`, `evaluator`, `agents`, `envs`, `errors`. A layer imports only from those
below it, and importing this package imports nothing else.
"""

__version__ = "0.1.0"
