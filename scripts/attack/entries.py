"""Bad entries: each ends in one line that says what to mend, from `validate`, `package` and `evaluate` alike."""

import gzip
import io
import os
import re
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
            ("agent_config.yml", config, "interpolation_order: 3\nenv: 3dof-hit\n"),
            ("agent_builder.py", builder, GOOD),
        ):
            given = usual if content is None else content
            (entry / name).write_bytes(given if isinstance(given, bytes) else given.encode())
        return entry

    return make


def _field(name: str, value: str) -> Make:
    """An entry of whose metadata one field is another."""
    return _folder(re.sub(rf"^{name}: .*$", lambda _: f"{name}: {value}", NOBODY, flags=re.MULTILINE))


def _and(more: str) -> Make:
    """An entry whose metadata goes on with this."""
    return _folder(NOBODY + more)


def _builder(code: str | bytes) -> Make:
    """An entry of this code."""
    return _folder(builder=code)


def _instead(name: str, make: Callable[[Path], object]) -> Make:
    """An entry in which something else lies in a file's place."""

    def change(entry: Path) -> None:
        (entry / name).unlink()
        make(entry / name)

    return _with(change)


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


LOCAL, CENTRAL, END = b"PK\x03\x04", b"PK\x01\x02", b"PK\x05\x06"
"""What a file's own header, its line in the directory, and the directory's end begin with."""


def _patched(*fields: tuple[bytes, int, str, int]) -> Callable[[bytes], bytes]:
    """Write a number into every header: which header, where in it, in what form, which number."""

    def change(raw: bytes) -> bytes:
        changed = bytearray(raw)
        for signature, offset, form, number in fields:
            start = -1
            while (start := raw.find(signature, start + 1)) >= 0:
                struct.pack_into(form, changed, start + offset, number)
        return bytes(changed)

    return change


def _method(number: int) -> Callable[[bytes], bytes]:
    """Say of every file that it is compressed by this method."""
    return _patched((LOCAL, 8, "<H", number), (CENTRAL, 10, "<H", number))


def _no_name(raw: bytes) -> bytes:
    """The name of the last file, emptied in the directory."""
    start = raw.rfind(CENTRAL)
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


def _bytes(place: Path, content: bytes) -> Path:
    """An archive of these bytes."""
    (place / "entry.zip").write_bytes(content)
    return place / "entry.zip"


def _made(path: Path, make: Callable[[Path], object]) -> Path:
    """A path at which something was made."""
    make(path)
    return path


def _hard_link(entry: Path) -> None:
    """Something of the host's under two names: its content counts, and a name in the entry is the entry's."""
    (entry.parent / "other").write_text("x")
    os.link(entry.parent / "other", entry / "data.bin")
    (entry / "agent_builder.py").write_text("raise ValueError\n")


def _sparse(entry: Path) -> None:
    (entry / "weights.bin").touch()
    os.truncate(entry / "weights.bin", 9 << 30)


def _socket(entry: Path) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        before = os.getcwd()
        os.chdir(entry)
        one.bind("socket")
        os.chdir(before)


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
    "metadata: duplicate keys": _and("name: other\n"),
    "metadata: aliases that unfold to gigabytes": _folder(LAUGHS),
    "metadata: a tag of Python": _folder("name: !!python/object/apply:os.system ['touch owned']\ntasks: [3dof-hit]\n"),
    "metadata: a huge number": _field("interpolation_order", "9" * 5000),
    "metadata: a huge number by sixties": _field("interpolation_order", "1" + ":59" * 3000),
    "metadata: an impossible date": _field("interpolation_order", "2023-13-45"),
    "metadata: a name with letters that turn around": _field("name", f'"{BIDI}"'),
    "metadata: a name with control characters": _field("name", r'"\e[2Jentry"'),
    "metadata: a name with markup": _field("name", '"[red]<script>"'),
    "metadata: a name of blanks": _field("name", '"  "'),
    "metadata: no tasks": _field("tasks", "[]"),
    "metadata: an unknown task": _field("tasks", "[9dof-hit]"),
    "metadata: a list instead of names": _folder("- a\n- b\n"),
    "metadata: a key that is no text": _and("1: 2\n"),
    "metadata: a key that is a list": _and("? [a, b]\n: 2\n"),
    "metadata: unknown keys": _and("colour: green\n"),
    "metadata: two documents": _and("---\n" + NOBODY),
    "metadata: not UTF-8": _folder(NOBODY.encode() + b"authors: [\xff\xfe]\n"),
    "metadata: a zero byte": _folder(NOBODY.encode() + b"authors: [\0]\n"),
    "metadata: brackets without end": _folder("name: " + "[" * 50_000),
    "metadata: a megabyte and more": _and("#" * (2 << 20)),
    "metadata: a requirement that is an option of pip": _and("packages: ['--index-url=http://x', '-e .']\n"),
    "metadata: an order that is true": _field("interpolation_order", "true"),
    "metadata: an order that is not a number": _field("interpolation_order", ".nan"),
    "metadata: authors that are no list": _and("authors: {a: b}\n"),
    "metadata: empty": _folder(""),
    "metadata: a name of ten thousand letters": _field("name", "e" * 10_000),
    "metadata: a name that is a path": _field("name", "../../entry"),
    "metadata: a merge key": _folder("base: {name: entry}\n<<: {name: other}\n" + NOBODY),
    "metadata: a file without end": _with(lambda entry: os.truncate(entry / "submission.yaml", 1 << 33)),
    "configuration: a tag of Python": _folder(config="speed: !!python/object/apply:os.getcwd []\n"),
    "configuration: aliases that unfold to gigabytes": _folder(config=LAUGHS),
    "configuration: a list": _folder(config="- 1\n- 2\n"),
    "configuration: not UTF-8": _folder(config=b"\xff\xfe: 1\n"),
    "metadata: a folder": _instead("submission.yaml", Path.mkdir),
    "configuration: keys that build_agent does not know": _folder(
        config="speed: 1.0\n", builder=GOOD.replace(", **kwargs", "")
    ),
    "configuration: an unknown order": _folder(config="interpolation_order: 17\n"),
    "configuration: keys that are taken": _folder(config="env_info: 3\n"),
    "builder: nothing in it": _builder(""),
    "builder: a syntax error": _builder("def build_agent(:\n"),
    "builder: not UTF-8": _builder(b"\xff\xfe\0\0"),
    "builder: a zero byte": _builder(b"x = 1\0\n"),
    "builder: returns nothing": _builder("def build_agent(env_info, **kwargs):\n    pass\n"),
    "builder: raises with control sequences": _builder("raise ValueError('\\x1b[2J[red]\\u202e' * 50)\n"),
    "builder: leaves": _builder("import os\nos._exit(0)\n"),
    "builder: nested without end": _builder("x = " + "(" * 5000 + ")" * 5000 + "\n"),
    "builder: starts processes without a guard": _builder(
        GOOD.replace(
            "self.steps = 0",
            "self.steps = 0\n        import multiprocessing as mp\n        mp.get_context('spawn').Process(target=print).start()",
        )
    ),
    "builder: ends the program": _builder("import sys\nsys.exit(0)\n"),
    "builder: is interrupted": _builder("raise KeyboardInterrupt\n"),
    "builder: raises what no text can say": _builder(
        "class E(BaseException):\n    def __str__(self):\n        raise self\nraise E\n"
    ),
    "builder: closes every descriptor": _builder("import os\nos.closerange(0, 256)\n" + GOOD),
    "builder: recurses without end": _builder("def f():\n    f()\nf()\n"),
    "builder: crashes the interpreter": _builder("import ctypes\nctypes.string_at(0)\n"),
    "builder: takes all memory": _builder("x = bytearray(1 << 60)\n"),
    "builder: its agent lacks draw_action": _builder(
        "class A:\n    def episode_start(self):\n        pass\ndef build_agent(env_info, **k):\n    return A()\n"
    ),
    "builder: lies about itself": _builder(
        "class A:\n    def __getattribute__(self, name):\n        raise ValueError('\\x1b[2J' + name)\n"
        "def build_agent(env_info, **k):\n    return A()\n"
    ),
    "builder: is not there": _instead("agent_builder.py", lambda _: None),
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
    "folder: a builder that is a pipe": _instead("agent_builder.py", os.mkfifo),
    "folder: a configuration that is a pipe": _instead("agent_config.yml", os.mkfifo),
    "folder: metadata that is a pipe": _instead("submission.yaml", os.mkfifo),
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
    "archive: files that lie over each other": _archive(
        ("x", bytes(1000)), ("y", bytes(1000)), change=_patched((CENTRAL, 42, "<I", 0))
    ),
    "archive: encrypted": _archive(("x", b"1"), change=_patched((LOCAL, 6, "<H", 1), (CENTRAL, 8, "<H", 1))),
    "archive: sizes that lie": _archive(("x", bytes(1000)), change=_patched((CENTRAL, 24, "<I", 0))),
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
    "archive: a name with a line end": _archive(("a\nb\x1b[2J", b"x")),
    "archive: names that are one once they are normalized": _archive(("\u00e9.txt", b"1"), ("e\u0301.txt", b"2")),
    "archive: a name that is another in the file's own header": _archive(
        ("innocent.txt", b"x"), change=lambda raw: raw.replace(b"innocent.txt", b"../../../out", 1)
    ),
    "archive: exabytes by ZIP64": _archive(
        (_info("x", extra=struct.pack("<HHQQ", 1, 16, 1 << 60, 1 << 60)), b"x"),
        change=_patched((CENTRAL, 24, "<I", 0xFFFFFFFF), (CENTRAL, 20, "<I", 0xFFFFFFFF)),
    ),
    "archive: a directory beyond its end": _archive(("x", b"x"), change=_patched((END, 16, "<I", 0x7FFFFFFF))),
    "archive: a directory of another size": _archive(("x", b"x"), change=_patched((END, 12, "<I", 0x7FFFFFFF))),
    "archive: files that begin beyond its end": _archive(("x", b"x"), change=_patched((CENTRAL, 42, "<I", 0x7FFFFFFF))),
    "archive: a version that nobody reads": _archive(("x", b"x"), change=_patched((CENTRAL, 6, "<H", 999))),
    "archive: wrong sums": _archive(("x", b"x"), change=_patched((CENTRAL, 16, "<I", 7))),
    "archive: an archive in its place in it": _archive(("agent_builder.py/entry.zip", b"PK\x05\x06" + bytes(18))),
    "archive: two builders": _archive(("a/agent_builder.py", GOOD.encode()), ("b/agent_builder.py", b""), good=False),
    "archive: a builder two folders down": _archive(("a/b/c/d/e/agent_builder.py", GOOD.encode()), good=False),
    "archive: a name that is no text": _archive(("xyz", b"x"), change=lambda raw: raw.replace(b"xyz", b"\xff\xfez")),
    "archive: of gzip": lambda place: _bytes(place, gzip.compress(GOOD.encode())),
    "archive: nothing at all": lambda place: _bytes(place, b""),
    "archive: only its end": lambda place: _bytes(place, b"PK\x05\x06" + bytes(18)),
    "archive: a device of the host": lambda _: Path("/dev/zero"),
    "archive: a pipe in its place": lambda place: _made(place / "entry.zip", os.mkfifo),
    "archive: a file that only seems to be large": lambda place: _made(
        place / "entry.zip", lambda path: (path.touch(), os.truncate(path, 1 << 40))
    ),
    "metadata: a version that is a number": _field("version", "1.0"),
    "metadata: a name that is nothing": _field("name", "null"),
    "metadata: a name of half a letter": _field("name", r'"\ud800"'),
    "metadata: tasks that are one text": _field("tasks", "3dof-hit"),
    "metadata: tasks with a task that is a number": _field("tasks", "[3dof-hit, 1e-3]"),
    "metadata: a set": _and("packages: !!set {numpy, scipy}\n"),
    "metadata: an ordered map": _and("packages: !!omap [a: 1]\n"),
    "metadata: tabulators": _folder(NOBODY.replace("name: entry", "\tname: entry")),
    "metadata: UTF-16": _folder(NOBODY.encode("utf-16")),
    "metadata: a directive of another version": _folder("%YAML 9.9\n---\n" + NOBODY),
    "metadata: an anchor that means itself": _and("packages: &a [*a]\n"),
    "metadata: a number of a thousand digits behind the point": _field("interpolation_order", "3." + "0" * 999 + "1"),
    "metadata: ten thousand keys": _folder(NOBODY + "".join(f"key{k}: {k}\n" for k in range(10_000))),
    "configuration: a number that is none": _folder(config="interpolation_order: .inf\n"),
    "configuration: a name that shuts out self": _folder(config="self: 3\nagent_id: 2\n"),
    "configuration: nested without end": _folder(config="speed: " + "[" * 20_000),
    "configuration: a folder": _instead("agent_config.yml", Path.mkdir),
    "builder: a folder": _instead("agent_builder.py", Path.mkdir),
    "builder: text of a billion brackets": _builder("x = " + "[" * 900_000),
    "builder: a number of a million digits": _builder("x = " + "9" * 1_000_000 + "\n"),
    "builder: warns with control sequences": _builder(
        "import warnings\nwarnings.warn('\\x1b[2J[red]\\u202e')\nraise SystemExit('\\x1b[2J')\n"
    ),
    "builder: logs with control sequences": _builder(
        "import logging, sys\nlogging.critical('\\x1b[2J\\u202e')\nprint('\\x1b[2J', file=sys.__stderr__)\nx\n"
    ),
    "builder: raises a group": _builder(
        "raise BaseExceptionGroup('all', [ValueError('\\x1b[2J'), KeyboardInterrupt()])\n"
    ),
    "builder: raises a class of its own name": _builder("raise type('\\x1b[2J\\u202eError', (Exception,), {})('x')\n"),
    "builder: raises an endless chain": _builder(
        "def f(n):\n    try:\n        g(n)\n    except Exception as e:\n        raise ValueError('x' * 10000) from e\n"
        "def g(n):\n    if n:\n        f(n - 1)\n    raise KeyError\nf(300)\n"
    ),
    "builder: takes away what everybody needs": _builder(
        "import builtins, sys, os\ndel builtins.print, builtins.open\nsys.modules.clear()\nraise Exception\n"
    ),
    "builder: hooks every exception": _builder(
        "import sys, threading\nsys.excepthook = threading.excepthook = sys.unraisablehook = lambda *_: print('\\x1b[2J')\nx\n"
    ),
    "builder: forks and both answer": _builder("import os\nos.fork()\nos.fork()\nraise ValueError\n"),
    "builder: its agent is a class": _builder("class A:\n    pass\ndef build_agent(env_info, **k):\n    return A\n"),
    "builder: its order is a riddle": _builder(
        GOOD.replace("    pass\n\ndef", "    interpolation_order = property(lambda self: 1 / 0)\n\ndef")
    ),
    "folder: names that only their capitals tell apart": _with(
        lambda entry: [(entry / name).write_text("x") for name in ("data.txt", "DATA.TXT")]
    ),
    "folder: seventy thousand files": _with(lambda entry: [(entry / str(k)).touch() for k in range(70_000)]),
    "folder: a hard link to a file of the host": _with(lambda entry: _hard_link(entry)),
    "folder: a link in a folder": _with(
        lambda entry: _made(entry / "parts", Path.mkdir) and _link("/etc", "parts/x")(entry)
    ),
    "folder: an empty one": lambda place: _made(place / "entry", Path.mkdir),
    "folder: not there": lambda place: place / "entry" / "nowhere",
    "folder: the root of all": lambda _: Path("/proc/self"),
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
