"""A run's folder: begun empty, taken up again as the same run, written by one process at a time, killed at any moment.

    run.json, match.json …    the manifest
    journal.jsonl             a line per finished piece of work
    result.json               once everything is done

Each kind of run says in a class of its own what it is called, and what else lies in its folder.
"""

import contextlib
import os
from collections.abc import Hashable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Generic, Self, TypeVar

import msgspec

from airhockey import envs
from airhockey.envs.copying import NotCopyable
from airhockey.envs.disturbances import load_disturbances
from airhockey.errors import ConfigurationError
from airhockey.evaluator.runs import journal
from airhockey.evaluator.runs.disk import begin_folder, disk_errors, lock_folder, write_record
from airhockey.evaluator.runs.inputs import check_unchanged, hashes_of, in_full
from airhockey.evaluator.runs.journal import Record
from airhockey.evaluator.runs.manifest import (
    Manifest,
    check_same_run,
    check_seal,
    check_versions,
    note_on_profile,
    now,
    option_of,
    read_manifest,
    sealed,
)
from airhockey.inputs.names import shown

Options = TypeVar("Options")


class RunFolder(NotCopyable, Generic[Options, Record]):
    """A run's folder, opened for writing.

    Attributes:
        name: The manifest's file name.
        options_type, record_type: What the options and the journal's lines are.
        manifest_type: `Manifest`, or a kind of it.
        path: The folder.
        manifest: What the run is.
        records: Of the finished work.
        notes: What is to be told of a run that is taken up again.
    """

    name: ClassVar[str]
    options_type: ClassVar[type]
    record_type: ClassVar[type]
    manifest_type: ClassVar[Any] = Manifest
    manifest: Manifest[Options]

    def __init__(self, path: Path, asked: Mapping[str, Any] | None = None) -> None:
        """Use `begin`, `resume` or `open`."""
        self.path = path
        self.notes: list[str] = []
        self._lock = lock_folder(path)
        with self.released_on_error():
            self.manifest = self.read(path)
            if asked is not None:
                check_same_run(path, self.manifest, asked)
                check_versions(path, self.manifest.versions, self.versions())
                check_unchanged(path, self.manifest.inputs)
                check_seal(path, self.name, self.manifest)
                self.notes += filter(None, [note_on_profile(path, self.manifest)])
            with disk_errors(path):
                self.records: list[Record] = self.recover()

    @classmethod
    def begin(cls, options: Options, path: Path, **more: Any) -> Self:
        """Begin a run in a folder that does not exist or is empty; nothing is written when anything about it is wrong.

        Args:
            options: What is asked for.
            path: The folder.
            **more: Fields that only this kind of manifest has.

        Raises:
            ConfigurationError: An option has no meaning, or the folder holds something or cannot be written.
        """
        options = in_full(options)
        cls.check(options)
        return cls.create(
            path,
            cls.manifest_type(
                options=options,
                profile=load_disturbances(option_of(options, "disturbances")),
                versions=cls.versions(),
                created=now(),
                inputs=hashes_of(options),
                **more,
            ),
        )

    @classmethod
    def resume(cls, path: Path, asked: Mapping[str, Any] | None = None) -> Self:
        """Take up a run that was interrupted.

        Args:
            path: Its folder.
            asked: Options that the user repeated, by name; they must be the run's.

        Raises:
            ConfigurationError: There is no run, it is another than the one asked for, the software is, or another process
                is at work on it.
        """
        cls.read(path)
        return cls(path, asked or {})

    @classmethod
    def create(cls, path: Path, manifest: Manifest[Options]) -> Self:
        """Begin what a manifest says; raises `ConfigurationError`."""
        begin_folder(path, cls.name, sealed(manifest))
        return cls(path)

    @classmethod
    def open(cls, path: Path) -> Self:
        """Take up a run whatever it is; raises `ConfigurationError`."""
        cls.read(path)
        return cls(path)

    @classmethod
    def read(cls, path: Path) -> Manifest[Options]:
        """The manifest in a folder, see `read_manifest`."""
        return read_manifest(path, cls.name, cls.options_type, cls.manifest_type)

    @classmethod
    def check(cls, options: Options) -> None:
        """Find the mistakes in a run's options; raises `ConfigurationError`."""

    @classmethod
    def versions(cls) -> dict[str, str]:
        """Of the software that results depend on."""
        return envs.versions()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Let others have it."""
        os.close(self._lock)

    @contextlib.contextmanager
    def released_on_error(self) -> Iterator[None]:
        """Let others have it if the block fails."""
        try:
            yield
        except BaseException:
            self.close()
            raise

    @property
    def done(self) -> set[Hashable]:
        """Keys of the work that need not be done again."""
        return {record.key for record in self.records}

    def recover(self) -> list[Record]:
        """The records of the finished work; what a kill left half done goes away."""
        records: list[Record] = self.believed(journal.read_journal(self.path, self.record_type).records)
        journal.mend(self.path, records)
        return records

    def believed(self, records: list[Record]) -> list[Record]:
        """The records that are what was written; the work of the others is done again."""
        return records

    def check_work(self, work: Iterable[Hashable]) -> None:
        """What is finished must be part of the run's work, of which these are the keys; raises `ConfigurationError`."""
        foreign = self.done.difference(work)
        if foreign:
            raise ConfigurationError(
                f"the journal in {str(self.path)!r} holds what is no part of this run ({shown(min(map(str, foreign)))}):"
                " it was edited, or comes from another run; put its content back, or begin a new run with another --out"
            )

    def keep(self, *records: Record) -> None:
        """Keep records; they are on the disk when this returns, and what they tell of is finished."""
        with disk_errors(self.path):
            journal.append(self.path, records)
        self.records += records

    def change(self, options: Options) -> None:
        """Replace the options of a run that may be extended."""
        inputs = hashes_of(options) | self.manifest.inputs
        manifest = sealed(msgspec.structs.replace(self.manifest, options=options, inputs=inputs))
        with disk_errors(self.path):
            write_record(self.path / self.name, manifest)
        self.manifest = manifest

    def keep_result(self, result: msgspec.Struct) -> None:
        """Leave the result beside what it was computed from; raises `ConfigurationError` where that was changed meanwhile."""
        check_unchanged(self.path, self.manifest.inputs)
        with disk_errors(self.path):
            write_record(self.path / "result.json", result)
