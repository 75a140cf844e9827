"""Compiled code is loaded undisturbed: LLVM calls back into Python there, where an exception ends the process."""

import subprocess
import sys

PROGRAM = """
import signal
from llvmlite.binding.executionengine import ExecutionEngine
from foldcut.core.compiled import compiler

found = ExecutionEngine._find_module_ptr
signals = [signal.SIGINT]

def signalled(self, pointer):
    if signals:
        signal.raise_signal(signals.pop())
    return found(self, pointer)

ExecutionEngine._find_module_ptr = signalled  # called back when machine code is made

@compiler()
def twice(number):
    return 2 * number

try:
    twice(1)
except KeyboardInterrupt:
    print(signals, twice(2))
"""


def test_ctrl_c_waits_while_machine_code_is_made() -> None:
    ran = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False)
    assert (ran.stdout, ran.returncode) == ("[] 4\n", 0), ran.stderr
