"""Programs run for real: started, waited for by what they say, and always stopped.

Nothing here depends on how fast the machine is: every wait is for a condition, and ends at once where
it holds.
"""
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest

# So long that it only ends what would never come, on a machine that has much else to do too.
PATIENCE_S = 120


def wait_for(what, condition, patience_s=PATIENCE_S):
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline:
        found = condition()
        if found:
            return found
        time.sleep(0.05)
    raise AssertionError(f"waited {patience_s} s for {what}")


# Below all that the kernel gives to those who ask for any: what it has given once and taken back is
# given to the next who asks, maybe before the program of a test listens there.
PORTS = range(20000, 32768)
claims = []


def free_port():
    """A port for a program of this test: no other test gets it until this one ends."""
    for port in PORTS:
        claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            claim.bind(f"\0etcm-test-port-{port}")
            with socket.socket() as probe:
                probe.bind(("", port))
        except OSError:
            claim.close()
            continue
        claims.append(claim)
        return port
    raise AssertionError(f"no free port from {PORTS.start} to {PORTS.stop - 1}")


class Program:
    """A running program with its output in a file."""

    def __init__(self, folder, name, command):
        self.log_path = folder / f"{name}.log"
        self.log_file = open(self.log_path, "w")
        self.process = subprocess.Popen(command, stdout=self.log_file, stderr=subprocess.STDOUT,
                                        cwd=folder)

    def log(self):
        return self.log_path.read_text()

    def wait_for_line(self, pattern):
        def found():
            ended = self.process.poll() is not None
            match = re.search(pattern, self.log())
            if ended and not match:
                raise AssertionError(f"ended without '{pattern}'")
            return match

        try:
            return wait_for(f"'{pattern}'", found)
        except AssertionError as error:
            raise AssertionError(f"{self.log_path.stem} {error}\n{self.log()}") from None

    def stop(self, number=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(number)
        status = self.process.wait(PATIENCE_S)
        self.log_file.close()
        return status


class ProgramCase(unittest.TestCase):
    """A test with a folder of its own and programs that run in it."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="etcm_test_"))
        self.programs = []

    def tearDown(self):
        for program in self.programs:
            if program.process.poll() is None:
                program.process.kill()
            program.process.wait()
            program.log_file.close()
        shutil.rmtree(self.folder)

    def start(self, name, command):
        program = Program(self.folder, name, [str(part) for part in command])
        self.programs.append(program)
        return program
