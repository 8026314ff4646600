"""Bad entries: each ends in one line that says what to mend, from `validate`, `package` and `evaluate` alike."""

import io
import os
import socket
import stat
import struct
import tarfile
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import product
from cheats import HEAD, TAIL, trouble
from verdicts import ESCAPE, HELD, Verdict

KIND = "bad entries"
GOOD = HEAD + "class Agent(Base):\n    pass\n" + TAIL
NOBODY = "name: entry\nversion: 0.1.0\ninterpolation_order: 3\ntasks: [3dof-hit]\n"
Make = Callable[[Path], Path]
BIDI = "\u202egpj.exe"


def _folder(
    metadata: str | bytes | None = None, config: str | bytes | None = None, builder: str | bytes | None = None
) -> Make:
    """An entry whose files say this."""

    def make(place: Path) -> Path:
        entry = place / "entry"
        entry.mkdir()
        for name, content, usual in (
            ("submission.yaml", metadata, NOBODY),
            ("agent_config.yml", config, "interpolation_order: 3\n"),
            ("agent_builder.py", builder, GOOD),
        ):
            given = usual if content is None else content
            (entry / name).write_bytes(given if isinstance(given, bytes) else given.encode())
        return entry

    return make


def _with(change: Callable[[Path], None]) -> Make:
    """A good entry, changed."""

    def make(place: Path) -> Path:
        entry = _folder()(place)
        change(entry)
        return entry

    return make


def _archive(
    *files: tuple[str | zipfile.ZipInfo, bytes], change: Callable[[bytes], bytes] = bytes, good: bool = True
) -> Make:
    """A zip file of an entry with more files in it, its bytes changed."""

    def make(place: Path) -> Path:
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w") as archive:
            if good:
                archive.writestr("agent_builder.py", GOOD)
                archive.writestr("submission.yaml", NOBODY)
            for name, content in files:
                archive.writestr(name, content)
        path = place / "entry.zip"
        path.write_bytes(change(stream.getvalue()))
        return path

    return make


def _info(name: str, mode: int = 0, extra: bytes = b"") -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
    info.external_attr, info.create_system, info.extra = mode << 16, 3, extra
    return info


def _method(number: int) -> Callable[[bytes], bytes]:
    """Say of every file that it is compressed by this method."""

    def change(raw: bytes) -> bytes:
        changed = bytearray(raw)
        for signature, offset in ((b"PK\x03\x04", 8), (b"PK\x01\x02", 10)):
            start = 0
            while (start := raw.find(signature, start)) >= 0:
                struct.pack_into("<H", changed, start + offset, number)
                start += 4
        return bytes(changed)

    return change


def _no_name(raw: bytes) -> bytes:
    """The name of the last file, emptied in the directory."""
    start = raw.rfind(b"PK\x01\x02")
    changed = bytearray(raw)
    length = struct.unpack_from("<H", raw, start + 28)[0]
    struct.pack_into("<H", changed, start + 28, 0)
    del changed[start + 46 : start + 46 + length]
    return bytes(changed)


def _bomb(place: Path) -> Path:
    path = place / "entry.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("agent_builder.py", GOOD)
        with archive.open("zeros", "w", force_zip64=True) as sink:
            for _ in range(1100):
                sink.write(bytes(1 << 20))
    return path


def _many(place: Path) -> Path:
    path = place / "entry.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(70_000):
            archive.writestr(f"f{number}", b"")
    return path


def _link(target: str, name: str = "data.bin") -> Callable[[Path], None]:
    return lambda entry: (entry / name).symlink_to(target)


def _both(*_: object) -> None:
    """Two things in one expression."""


def _sparse(entry: Path) -> None:
    (entry / "weights.bin").touch()
    os.truncate(entry / "weights.bin", 9 << 30)


def _socket(entry: Path) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        before = os.getcwd()
        os.chdir(entry)
        one.bind("socket")
        os.chdir(before)


def _overlapping(raw: bytes) -> bytes:
    """Let every file of the directory be the first one."""
    changed, start = bytearray(raw), 0
    while (start := raw.find(b"PK\x01\x02", start)) >= 0:
        struct.pack_into("<I", changed, start + 42, 0)
        start += 4
    return bytes(changed)


def _encrypted(raw: bytes) -> bytes:
    """Say of every file that it is."""
    changed = bytearray(raw)
    for signature, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        start = 0
        while (start := raw.find(signature, start)) >= 0:
            changed[start + offset] |= 1
            start += 4
    return bytes(changed)


def _sizes_that_lie(raw: bytes) -> bytes:
    """Say of every file that it is empty once it is unpacked."""
    changed, start = bytearray(raw), 0
    while (start := raw.find(b"PK\x01\x02", start)) >= 0:
        struct.pack_into("<I", changed, start + 24, 0)
        start += 4
    return bytes(changed)


def _tar(place: Path) -> Path:
    path = place / "entry.tar"
    with tarfile.open(path, "w") as archive:
        for name, kind, target in (
            ("link", tarfile.LNKTYPE, "/etc/passwd"),
            ("disk", tarfile.BLKTYPE, ""),
            ("../out", tarfile.REGTYPE, ""),
        ):
            info = tarfile.TarInfo(name)
            info.type, info.linkname = kind, target
            archive.addfile(info)
    return path


def _deep(entry: Path) -> None:
    here = entry
    for _ in range(120):
        here = here / "deeper"
        here.mkdir()
    (here / "file.txt").write_text("x")


NINE = ["&a0 [x]"] + [f"&a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 10)]
LAUGHS = "name: entry\nparts:\n" + "".join(f"  - {line}\n" for line in NINE)
LINK = stat.S_IFLNK | 0o777
ENTRIES: dict[str, Make] = {
    "metadata: duplicate keys": _folder(NOBODY + "name: other\n"),
    "metadata: aliases that unfold to gigabytes": _folder(LAUGHS),
    "metadata: a tag of Python": _folder("name: !!python/object/apply:os.system ['touch owned']\ntasks: [3dof-hit]\n"),
    "metadata: a huge number": _folder(NOBODY.replace("order: 3", "order: " + "9" * 5000)),
    "metadata: a huge number by sixties": _folder(NOBODY.replace("order: 3", "order: 1" + ":59" * 3000)),
    "metadata: an impossible date": _folder(NOBODY.replace("order: 3", "order: 2023-13-45")),
    "metadata: a name with letters that turn around": _folder(NOBODY.replace("name: entry", f'name: "{BIDI}"')),
    "metadata: a name with control characters": _folder(NOBODY.replace("name: entry", r'name: "\e[2Jentry"')),
    "metadata: a name with markup": _folder(NOBODY.replace("name: entry", 'name: "[red]<script>"')),
    "metadata: a name of blanks": _folder(NOBODY.replace("name: entry", 'name: "  "')),
    "metadata: no tasks": _folder(NOBODY.replace("[3dof-hit]", "[]")),
    "metadata: an unknown task": _folder(NOBODY.replace("3dof-hit", "9dof-hit")),
    "metadata: a list instead of names": _folder("- a\n- b\n"),
    "metadata: a key that is no text": _folder(NOBODY + "1: 2\n"),
    "metadata: a key that is a list": _folder(NOBODY + "? [a, b]\n: 2\n"),
    "metadata: unknown keys": _folder(NOBODY + "colour: green\n"),
    "metadata: two documents": _folder(NOBODY + "---\n" + NOBODY),
    "metadata: not UTF-8": _folder(NOBODY.encode() + b"authors: [\xff\xfe]\n"),
    "metadata: a zero byte": _folder(NOBODY.encode() + b"authors: [\0]\n"),
    "metadata: brackets without end": _folder("name: " + "[" * 50_000),
    "metadata: a megabyte and more": _folder(NOBODY + "#" * (2 << 20)),
    "metadata: a requirement that is an option of pip": _folder(
        NOBODY + "packages: ['--index-url=http://x', '-e .']\n"
    ),
    "metadata: an order that is true": _folder(NOBODY.replace("order: 3", "order: true")),
    "metadata: an order that is not a number": _folder(NOBODY.replace("order: 3", "order: .nan")),
    "metadata: authors that are no list": _folder(NOBODY + "authors: {a: b}\n"),
    "metadata: empty": _folder(""),
    "metadata: a name of ten thousand letters": _folder(NOBODY.replace("name: entry", "name: " + "e" * 10_000)),
    "metadata: a name that is a path": _folder(NOBODY.replace("name: entry", "name: ../../entry")),
    "metadata: a merge key": _folder("base: {name: entry}\n<<: {name: other}\n" + NOBODY),
    "metadata: a file without end": _with(lambda entry: os.truncate(entry / "submission.yaml", 1 << 33)),
    "configuration: a tag of Python": _folder(config="speed: !!python/object/apply:os.getcwd []\n"),
    "configuration: aliases that unfold to gigabytes": _folder(config=LAUGHS),
    "configuration: a list": _folder(config="- 1\n- 2\n"),
    "configuration: not UTF-8": _folder(config=b"\xff\xfe: 1\n"),
    "metadata: a folder": _with(
        lambda entry: _both((entry / "submission.yaml").unlink(), (entry / "submission.yaml").mkdir())
    ),
    "configuration: keys that build_agent does not know": _folder(
        config="speed: 1.0\n", builder=GOOD.replace(", **kwargs", "")
    ),
    "configuration: an unknown order": _folder(config="interpolation_order: 17\n"),
    "configuration: keys that are taken": _folder(config="env_info: 3\n"),
    "builder: nothing in it": _folder(builder=""),
    "builder: a syntax error": _folder(builder="def build_agent(:\n"),
    "builder: not UTF-8": _folder(builder=b"\xff\xfe\0\0"),
    "builder: a zero byte": _folder(builder=b"x = 1\0\n"),
    "builder: returns nothing": _folder(builder="def build_agent(env_info, **kwargs):\n    pass\n"),
    "builder: raises with control sequences": _folder(builder="raise ValueError('\\x1b[2J[red]\\u202e' * 50)\n"),
    "builder: leaves": _folder(builder="import os\nos._exit(0)\n"),
    "builder: nested without end": _folder(builder="x = " + "(" * 5000 + ")" * 5000 + "\n"),
    "builder: starts processes without a guard": _folder(
        builder=GOOD.replace(
            "self.steps = 0",
            "self.steps = 0\n        import multiprocessing as mp\n        mp.get_context('spawn').Process(target=print).start()",
        )
    ),
    "builder: ends the program": _folder(builder="import sys\nsys.exit(0)\n"),
    "builder: is interrupted": _folder(builder="raise KeyboardInterrupt\n"),
    "builder: raises what no text can say": _folder(
        builder="class E(BaseException):\n    def __str__(self):\n        raise self\nraise E\n"
    ),
    "builder: closes every descriptor": _folder(builder="import os\nos.closerange(0, 256)\n" + GOOD),
    "builder: recurses without end": _folder(builder="def f():\n    f()\nf()\n"),
    "builder: crashes the interpreter": _folder(builder="import ctypes\nctypes.string_at(0)\n"),
    "builder: takes all memory": _folder(builder="x = bytearray(1 << 60)\n"),
    "builder: its agent lacks draw_action": _folder(
        builder="class A:\n    def episode_start(self):\n        pass\ndef build_agent(env_info, **k):\n    return A()\n"
    ),
    "builder: lies about itself": _folder(
        builder="class A:\n    def __getattribute__(self, name):\n        raise ValueError('\\x1b[2J' + name)\n"
        "def build_agent(env_info, **k):\n    return A()\n"
    ),
    "builder: is not there": _with(lambda entry: (entry / "agent_builder.py").unlink()),
    "folder: a link to a file of the host": _with(_link("/etc/passwd")),
    "folder: a link to a folder of the host": _with(_link("/etc", "data")),
    "folder: a link to itself": _with(_link("data.bin")),
    "folder: a builder that is a link": _with(
        lambda entry: (
            (entry / "agent_builder.py").rename(entry.parent / "b.py"),
            _link("../b.py", "agent_builder.py")(entry),
        )[-1]
    ),
    "folder: a pipe": _with(lambda entry: os.mkfifo(entry / "pipe")),
    "folder: a name with letters that turn around": _with(lambda entry: (entry / BIDI).write_text("x")),
    "folder: a name with a line end": _with(lambda entry: (entry / "a\nb\x1b[2J").write_text("x")),
    "folder: a name that is no text": _with(
        lambda entry: Path(os.fsdecode(os.fsencode(entry) + b"/\xff")).write_text("x")
    ),
    "folder: very deep": _with(_deep),
    "folder: a file larger than any disk": _with(_sparse),
    "folder: a builder larger than any disk": _with(lambda entry: os.truncate(entry / "agent_builder.py", 1 << 34)),
    "folder: a socket": _with(_socket),
    "folder: a builder that is a pipe": _with(
        lambda entry: _both((entry / "agent_builder.py").unlink(), os.mkfifo(entry / "agent_builder.py"))
    ),
    "folder: a configuration that is a pipe": _with(
        lambda entry: _both((entry / "agent_config.yml").unlink(), os.mkfifo(entry / "agent_config.yml"))
    ),
    "folder: metadata that is a pipe": _with(
        lambda entry: _both((entry / "submission.yaml").unlink(), os.mkfifo(entry / "submission.yaml"))
    ),
    "archive: climbs out": _archive(("../../out.txt", b"x")),
    "archive: absolute": _archive(("/tmp/out.txt", b"x")),
    "archive: of Windows": _archive(("C:\\out.txt", b"x")),
    "archive: a link": _archive((_info("link", LINK), b"/etc/passwd")),
    "archive: a device": _archive((_info("device", stat.S_IFCHR | 0o666), b"")),
    "archive: the same name twice": _archive(("a.txt", b"1"), ("A.TXT", b"2")),
    "archive: a file and a folder of one name": _archive(("a", b"1"), ("a/b", b"2")),
    "archive: a name with letters that turn around": _archive((BIDI, b"x")),
    "archive: an empty name": _archive(("x", b""), change=_no_name),
    "archive: broken LZMA": _archive(("x", b"123456789" * 20), change=_method(14)),
    "archive: broken BZ2": _archive(("x", b"123456789" * 20), change=_method(12)),
    "archive: a method that nobody knows": _archive(("x", b"1"), change=_method(99)),
    "archive: cut off": _archive(("x", bytes(1000)), change=lambda raw: raw[:-40]),
    "archive: bytes changed": _archive(("x", bytes(1000)), change=lambda raw: raw[:100] + b"\xff" * 50 + raw[150:]),
    "archive: no zip file at all": _archive(change=lambda raw: b"\x7fELF" + raw[:50][::-1]),
    "archive: empty": _archive(good=False),
    "archive: a bomb": _bomb,
    "archive: files that lie over each other": _archive(("x", bytes(1000)), ("y", bytes(1000)), change=_overlapping),
    "archive: encrypted": _archive(("x", b"1"), change=_encrypted),
    "archive: sizes that lie": _archive(("x", bytes(1000)), change=_sizes_that_lie),
    "archive: a name longer than any file system's": _archive(("e" * 300, b"x")),
    "archive: a path longer than any file system's": _archive(("/".join(["e" * 200] * 40), b"x")),
    "archive: a pipe": _archive((_info("pipe", stat.S_IFIFO | 0o666), b"")),
    "archive: a link to a folder and a file through it": _archive(
        (_info("out", LINK), b"/tmp"), ("out/owned.txt", b"x")
    ),
    "archive: a name of Windows' devices and streams": _archive(("con:stream", b"x")),
    "archive: a zero byte in a name": _archive(("a/b", b"x"), change=lambda raw: raw.replace(b"a/b", b"a\0b")),
    "archive: dots only": _archive(("a/./../../b", b"x")),
    "archive: of another kind": _tar,
    "archive: seventy thousand files": _many,
}


SAMPLE = ("metadata: aliases that unfold to gigabytes", "archive: a link to a folder and a file through it")


def attack(sample: bool) -> Iterator[Verdict]:
    """Hand every bad entry to the commands that read entries."""
    for name in SAMPLE if sample else product.wanted(ENTRIES):
        make = ENTRIES[name]
        with product.fresh_place() as place:
            entry = make(place.path)
            before = _outside(place.path, entry)
            commands = [
                ("validate", str(entry), "--steps", "3"),
                ("evaluate", "--env", "3dof-hit", "--agent", str(entry), "--episodes", "1", "--jobs", "1", "--quiet"),
                ("package", str(entry)),
            ]
            yield _judged(
                name, [place.hockey(*command) for command in commands[: 1 if sample else 3]], before, place, entry
            )


def _judged(name: str, runs: list[product.Done], before: set[str], place: product.Place, entry: Path) -> Verdict:
    for done in runs:
        bad = trouble(KIND, name, done)
        if bad is not None:
            return bad
        if any(letter in done.out + done.err for letter in ("\x1b[2J", "\u202e")):
            return Verdict(KIND, name, ESCAPE, "control sequences reached the terminal")
    new = {path for path in _outside(place.path, entry) - before if not path.startswith(("runs", "entry"))}
    if new:
        return Verdict(KIND, name, ESCAPE, f"wrote {', '.join(sorted(new))}")
    if runs[0].status not in (2, 3):
        return Verdict(KIND, name, ESCAPE, f"validate found nothing: exit status {runs[0].status}")
    return Verdict(KIND, name, HELD, " / ".join(filter(None, (product.last_line(done) for done in runs))))


def _outside(place: Path, entry: Path) -> set[str]:
    return {path.relative_to(place).as_posix() for path in place.rglob("*") if entry not in (path, *path.parents)}
