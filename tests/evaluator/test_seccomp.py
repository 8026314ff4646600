"""The filter of system calls: interpreted here as the kernel would, and applied for real in a child."""

import errno
import platform
import struct
import subprocess
import sys

import pytest

from airhockey.evaluator.isolation.seccomp import MACHINES, Machine, program

ALLOWED, KILLED = 0x7FFF0000, 0x80000000


def verdict(machine: Machine, number: int, *arguments: int, audit: int | None = None) -> int:
    """What a filter says of a call: a BPF machine in a few lines."""
    data = struct.pack("=IIQ6Q", number, audit or machine.audit, 0, *(arguments + (0,) * 6)[:6])
    lines = list(struct.iter_unpack("=HBBI", program(machine)))
    accumulator, place = 0, 0
    while True:
        code, if_true, if_false, value = lines[place]
        place += 1
        if code == 0x20:
            accumulator = struct.unpack_from("=I", data, value)[0]
        elif code == 0x06:
            return int(value)
        else:
            holds = {0x15: accumulator == value, 0x35: accumulator >= value, 0x45: bool(accumulator & value)}[code]
            place += if_true if holds else if_false


def refusal(error: int) -> int:
    return 0x00050000 | error


@pytest.mark.parametrize("name", MACHINES)
def test_what_is_refused_is_refused_and_the_rest_is_not(name: str) -> None:
    machine = MACHINES[name]
    for number in machine.refused.values():
        assert verdict(machine, number) == refusal(errno.EPERM)
    own = {machine.clone, machine.clone3, machine.socket, machine.socketpair, machine.ioctl, machine.personality}
    for number in set(range(600)) - set(machine.refused.values()) - own:
        assert verdict(machine, number) == ALLOWED
    assert len(program(machine)) % 8 == 0 and len(program(machine)) // 8 < 4096


@pytest.mark.parametrize("name", MACHINES)
def test_calls_with_arguments(name: str) -> None:
    machine = MACHINES[name]
    threads, fork = 0x3D0F00, 0x1200011
    assert verdict(machine, machine.clone, threads) == verdict(machine, machine.clone, fork) == ALLOWED
    for flag in (0x20000, 0x2000000, 0x4000000, 0x8000000, 0x10000000, 0x20000000, 0x40000000):
        assert verdict(machine, machine.clone, fork | flag) == refusal(errno.EPERM)
    assert verdict(machine, machine.clone3) == refusal(errno.ENOSYS)
    for call in (machine.socket, machine.socketpair):
        families = {family for family in range(50) if verdict(machine, call, family, 1) == ALLOWED}
        assert families == {1, 2, 10}
    assert verdict(machine, machine.ioctl, 1, 0x5401) == ALLOWED
    for request in (0x5412, 0x541C, 0x5423):  # input for a terminal, its console, how it speaks
        assert verdict(machine, machine.ioctl, 0, request) == refusal(errno.EPERM)
    assert verdict(machine, machine.personality, 0xFFFFFFFF) == ALLOWED
    assert verdict(machine, machine.personality, 0x40000) == refusal(errno.EPERM)


@pytest.mark.parametrize("name", MACHINES)
def test_numbers_of_other_machines_do_not_pass(name: str) -> None:
    machine = MACHINES[name]
    assert verdict(machine, 1, audit=0x40000003) == KILLED
    assert verdict(machine, 0x40000000 | 1) == refusal(errno.ENOSYS)


CHILD = """
import ctypes, errno, os, socket, threading
from airhockey.evaluator.isolation import seccomp
waiting = threading.Event()
libc = ctypes.CDLL(None, use_errno=True)
libc.syscall.restype = ctypes.c_long
seen = []
def earlier():
    waiting.wait()
    number = seccomp.MACHINES[os.uname().machine].refused["ptrace"]
    seen.append((libc.syscall(ctypes.c_long(number), 0, 0, 0, 0), ctypes.get_errno()))
thread = threading.Thread(target=earlier)
thread.start()
assert seccomp.apply() is None
waiting.set()
thread.join()
assert seen == [(-1, errno.EPERM)], seen
try:
    socket.socket(socket.AF_NETLINK, socket.SOCK_RAW)
except OSError as error:
    assert error.errno == errno.EAFNOSUPPORT
threading.Thread(target=print, args=("threads work",)).start()
child = os.fork()
if child == 0:
    os._exit(0 if libc.unshare(0x10000000) != 0 else 1)
assert os.waitpid(child, 0)[1] == 0
print(os.popen("echo programs work").read())
"""


@pytest.mark.skipif(platform.machine() not in MACHINES, reason="no filter for this machine")
def test_applied_it_holds_for_threads_children_and_programs() -> None:
    done = subprocess.run([sys.executable, "-c", CHILD], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "threads work" in done.stdout and "programs work" in done.stdout
