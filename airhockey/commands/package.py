"""`hockey package`: the archive of a submission."""

from pathlib import Path

import rich_click as click


@click.command()
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option(
    "--out", metavar="FILE", type=click.Path(path_type=Path), help="The archive.  [default: NAME-VERSION.zip here]"
)
def package(folder: Path, out: Path | None) -> None:
    """Pack a submission: the same files give the same bytes, on any day and any machine.

    The archive holds a manifest with the hash of every file; one that was changed is refused by name. Hidden files, caches and
    links are left out, and named.

    \b
    hockey package my_agent
    hockey evaluate --agent my_agent-0.1.0.zip --task hit
    """
    from airhockey.agents.packaging.packing import pack

    packed = pack(folder, out)
    for name, why in packed.left_out.items():
        click.echo(f"left out: {name} ({why})", err=True)
    size = sum(file.bytes for file in packed.manifest.files.values())
    click.echo(f"{packed.path}  {len(packed.manifest.files)} files, {size} bytes")
    click.echo(f"sha256 {packed.sha256}")
