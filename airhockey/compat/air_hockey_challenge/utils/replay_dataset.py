"""`replay_dataset`: look at what an official evaluation left, with `hockey replay`."""

from pathlib import Path

from airhockey.compat.commands import hockey


def replay_dataset(env_name: str, dataset_path: str | Path) -> None:
    """Show the episodes of a `dataset.pkl`, until the viewer is left.

    Args:
        env_name: The environment that it was recorded in; the file's folder tells it too.
        dataset_path: The file.
    """
    file = Path(dataset_path)
    if not file.is_file():
        raise FileNotFoundError(f"there is no {str(file)!r}, which should hold what was recorded in {env_name}")
    hockey("replay", str(file))
