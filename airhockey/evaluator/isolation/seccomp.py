"""Which system calls the code of an entry may make: a filter for the kernel, as a program of BPF (`man 2 seccomp`).

Refused is what an agent has no use for and what is known for holes or for taking what nobody counts: keyrings, io_uring, ptrace,
other processes' memory, mounts, namespaces, BPF, modules, clocks, System V memory, odd families of sockets. The filter cannot be
taken off again, and holds for every thread and child.
"""

import ctypes
import errno
import os
import platform
import struct
from dataclasses import dataclass

_LOAD, _JUMP_EQUAL, _JUMP_AT_LEAST, _JUMP_ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _MACHINE, _ARGUMENTS = 0, 4, 16  # offsets in struct seccomp_data
_ALLOW, _KILL = 0x7FFF0000, 0x80000000
_X32 = 0x40000000
_PR_SET_NO_NEW_PRIVS, _SET_MODE_FILTER, _ALL_THREADS = 38, 1, 1
_JOIN_SESSION_KEYRING = 1

NAMESPACES = 0x7E020080  # CLONE_NEW{NS,CGROUP,UTS,IPC,USER,PID,NET} and CLONE_NEWTIME
FAMILIES = (1, 2, 10)  # AF_UNIX, AF_INET, AF_INET6
TERMINAL_INPUT = (0x5412, 0x541C, 0x5423)  # TIOCSTI, TIOCLINUX, TIOCSETD

# Numbers since 2019 are the same on every machine; before that there are x86_64's, and those of all younger ones.
_BOTH = {
    "pidfd_send_signal": 424, "io_uring_setup": 425, "io_uring_enter": 426, "io_uring_register": 427, "open_tree": 428,
    "move_mount": 429, "fsopen": 430, "fsconfig": 431, "fsmount": 432, "fspick": 433, "pidfd_getfd": 438,
    "process_madvise": 440, "mount_setattr": 442, "quotactl_fd": 443, "memfd_secret": 447, "process_mrelease": 448,
    "set_mempolicy_home_node": 450, "statmount": 457, "listmount": 458, "open_tree_attr": 467,
}  # fmt: skip
_X86_64 = {
    "shmget": 29, "shmat": 30, "shmctl": 31, "semget": 64, "semop": 65, "semctl": 66, "shmdt": 67, "msgget": 68, "msgsnd": 69,
    "msgrcv": 70, "msgctl": 71, "ptrace": 101, "syslog": 103, "uselib": 134, "ustat": 136, "sysfs": 139, "vhangup": 153,
    "modify_ldt": 154, "pivot_root": 155, "_sysctl": 156, "adjtimex": 159, "chroot": 161, "acct": 163, "settimeofday": 164,
    "mount": 165, "umount2": 166, "swapon": 167, "swapoff": 168, "reboot": 169, "sethostname": 170, "setdomainname": 171,
    "iopl": 172, "ioperm": 173, "create_module": 174, "init_module": 175, "delete_module": 176, "get_kernel_syms": 177,
    "query_module": 178, "quotactl": 179, "nfsservctl": 180, "lookup_dcookie": 212, "semtimedop": 220, "clock_settime": 227,
    "mbind": 237, "set_mempolicy": 238, "get_mempolicy": 239, "mq_open": 240, "mq_unlink": 241, "kexec_load": 246,
    "add_key": 248, "request_key": 249, "keyctl": 250, "migrate_pages": 256, "unshare": 272, "vmsplice": 278,
    "move_pages": 279, "perf_event_open": 298, "fanotify_init": 300, "fanotify_mark": 301, "name_to_handle_at": 303,
    "open_by_handle_at": 304, "clock_adjtime": 305, "setns": 308, "process_vm_readv": 310, "process_vm_writev": 311,
    "kcmp": 312, "finit_module": 313, "memfd_create": 319, "kexec_file_load": 320, "bpf": 321, "userfaultfd": 323,
}  # fmt: skip
_YOUNGER = {
    "umount2": 39, "mount": 40, "pivot_root": 41, "nfsservctl": 42, "chroot": 51, "vhangup": 58, "quotactl": 60,
    "vmsplice": 75, "acct": 89, "unshare": 97, "kexec_load": 104, "init_module": 105, "delete_module": 106,
    "clock_settime": 112, "syslog": 116, "ptrace": 117, "reboot": 142, "sethostname": 161, "setdomainname": 162,
    "settimeofday": 170, "adjtimex": 171, "mq_open": 180, "mq_unlink": 181, "msgget": 186, "msgctl": 187, "msgrcv": 188,
    "msgsnd": 189, "semget": 190, "semctl": 191, "semtimedop": 192, "semop": 193, "shmget": 194, "shmctl": 195, "shmat": 196,
    "shmdt": 197, "add_key": 217, "request_key": 218, "keyctl": 219, "swapon": 224, "swapoff": 225, "mbind": 235,
    "get_mempolicy": 236, "set_mempolicy": 237, "migrate_pages": 238, "move_pages": 239, "perf_event_open": 241,
    "fanotify_init": 262, "fanotify_mark": 263, "name_to_handle_at": 264, "open_by_handle_at": 265, "clock_adjtime": 266,
    "setns": 268, "process_vm_readv": 270, "process_vm_writev": 271, "kcmp": 272, "finit_module": 273, "memfd_create": 279,
    "bpf": 280, "userfaultfd": 282, "kexec_file_load": 294, "lookup_dcookie": 18,
}  # fmt: skip


@dataclass(frozen=True)
class Machine:
    """A kind of processor, as seccomp knows it.

    Attributes:
        audit: Its AUDIT_ARCH number.
        refused: Name -> number of each system call that is refused whatever its arguments.
        clone, clone3, socket, socketpair, ioctl, personality, seccomp, keyctl: Numbers of those with rules of their own.
    """

    audit: int
    refused: dict[str, int]
    clone: int
    socket: int
    socketpair: int
    ioctl: int
    personality: int
    seccomp: int
    clone3: int = 435

    @property
    def keyctl(self) -> int:
        """Number of the call that manages keys."""
        return self.refused["keyctl"]


MACHINES = {
    "x86_64": Machine(0xC000003E, _BOTH | _X86_64, 56, 41, 53, 16, 135, 317),
    "aarch64": Machine(0xC00000B7, _BOTH | _YOUNGER, 220, 198, 199, 29, 92, 277),
}


def program(machine: Machine) -> bytes:
    """The filter for one kind of processor: an array of struct sock_filter."""
    refuse, unknown = 0x00050000 | errno.EPERM, 0x00050000 | errno.ENOSYS
    lines = [
        _line(_LOAD, _MACHINE),
        _line(_JUMP_EQUAL, machine.audit, 1, 0),
        _line(_RETURN, _KILL),  # calls of 32 bits have other numbers
        _line(_LOAD, _NUMBER),
        _line(_JUMP_AT_LEAST, _X32, 0, 1),
        _line(_RETURN, unknown),
        *_unless(machine.clone3, [_line(_RETURN, unknown)]),  # its flags cannot be seen: the C library then takes clone
        *_unless(
            machine.clone, [_load(0), _line(_JUMP_ANY_BIT, NAMESPACES & ~0x80, 0, 1), _line(_RETURN, refuse), _allow()]
        ),
        *_unless(machine.socket, _only(FAMILIES, errno.EAFNOSUPPORT)),
        *_unless(machine.socketpair, _only(FAMILIES, errno.EAFNOSUPPORT)),
        *_unless(machine.ioctl, _except(TERMINAL_INPUT)),
        *_unless(machine.personality, _only((0, 8, 0x20000, 0x20008, 0xFFFFFFFF), errno.EPERM)),
    ]
    for number in sorted(set(machine.refused.values())):
        lines += _unless(number, [_line(_RETURN, refuse)])
    return b"".join((*lines, _allow()))


def apply() -> str | None:
    """Leave the session's keyring, and put the filter on this process and all its threads.

    Returns:
        Why it could not be done; None if it was.
    """
    machine = MACHINES.get(platform.machine())
    if machine is None:
        return f"no filter of system calls is known for {platform.machine()}"
    libc = ctypes.CDLL(None, use_errno=True)
    libc.syscall.restype = ctypes.c_long
    libc.syscall(ctypes.c_long(machine.keyctl), ctypes.c_long(_JOIN_SESSION_KEYRING), None)
    if libc.prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0:
        return "the kernel does not know no_new_privs"
    raw = program(machine)
    buffer = ctypes.create_string_buffer(raw, len(raw))
    described = struct.pack("@HP", len(raw) // 8, ctypes.addressof(buffer))
    done = libc.syscall(
        ctypes.c_long(machine.seccomp), ctypes.c_long(_SET_MODE_FILTER), ctypes.c_long(_ALL_THREADS), described
    )
    return None if done == 0 else f"the kernel takes no filter of system calls: {os.strerror(ctypes.get_errno())}"


def _line(code: int, value: int, if_true: int = 0, if_false: int = 0) -> bytes:
    return struct.pack("=HBBI", code, if_true, if_false, value & 0xFFFFFFFF)


def _allow() -> bytes:
    return _line(_RETURN, _ALLOW)


def _load(argument: int) -> bytes:
    """The lower half of an argument; both processors have their bytes in that order."""
    return _line(_LOAD, _ARGUMENTS + 8 * argument)


def _unless(number: int, lines: list[bytes]) -> list[bytes]:
    """Lines for one system call; skipped for all others."""
    return [_line(_JUMP_EQUAL, number, 0, len(lines)), *lines]


def _only(values: tuple[int, ...], error: int) -> list[bytes]:
    """Allow a call whose first argument is one of these; ends in a verdict."""
    lines = [_load(0)]
    for place, value in enumerate(values):
        lines.append(_line(_JUMP_EQUAL, value, len(values) - place, 0))
    return [*lines, _line(_RETURN, 0x00050000 | error), _allow()]


def _except(values: tuple[int, ...]) -> list[bytes]:
    """Refuse a call whose second argument is one of these; ends in a verdict."""
    lines = [_load(1)]
    for place, value in enumerate(values):
        lines.append(_line(_JUMP_EQUAL, value, len(values) - place, 0))
    return [*lines, _allow(), _line(_RETURN, 0x00050000 | errno.EPERM)]
