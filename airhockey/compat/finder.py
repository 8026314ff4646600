"""The import hook: names under `air_hockey_challenge` are files beside this one, or a submission's own."""

import importlib.abc
import importlib.machinery
import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from airhockey.compat.own_copy import NAME, OwnCopy

_ROOT = Path(__file__).parent


class Finder(importlib.abc.MetaPathFinder):
    """Finds the package and its modules.

    Attributes:
        own: The submission's own copy: it has what is missing here, or is used instead.
    """

    own: OwnCopy | None = None

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """The file of a module of the package; None for every other name, and for modules that it does not have."""
        parts = fullname.split(".")
        if parts[0] != NAME or (self.own is not None and self.own.wins):
            return None
        place = _ROOT.joinpath(*parts)
        module = "/".join(parts[1:])
        replaced = self.own.modules if self.own is not None else ()
        if self.own is not None and f"{module}.py" in replaced:
            return importlib.util.spec_from_file_location(fullname, self.own.folder / f"{module}.py")
        if (place / "__init__.py").is_file():
            places = [place] if self.own is None else [place, self.own.folder.joinpath(*parts[1:])]
            init = places[-1 if f"{module}/__init__.py" in replaced else 0] / "__init__.py"
            if self.own is not None and not module:
                init = self.own.init or init
            return importlib.util.spec_from_file_location(
                fullname, init, submodule_search_locations=[str(folder) for folder in places]
            )
        file = place.with_suffix(".py")
        return importlib.util.spec_from_file_location(fullname, file) if file.is_file() else None


def install(own: OwnCopy | None = None) -> None:
    """Let this process find the package. Twice is as good as once.

    Args:
        own: The copy that the submission about to be imported brings along. Modules of another one are forgotten.
    """
    finder = next((finder for finder in sys.meta_path if isinstance(finder, Finder)), None)
    if finder is None:
        finder = Finder()
        sys.meta_path.insert(0, finder)
    if finder.own != own:
        finder.own = own
        for name in [name for name in sys.modules if name.partition(".")[0] == NAME]:
            del sys.modules[name]
