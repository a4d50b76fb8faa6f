"""The gateway as a service, run for real: killed and started again, told to end, on a disk that
hangs, and what it tells systemd on a socket of the kind that systemd has.

The programs' folder is in ETCM_BIN.
"""
import os
import signal
import socket
import time
import unittest

from gateway_test import PATIENCE_S, GatewayCase, wait_for

STATE = '[state]\nfolder = "state"\ninterval = "1s"\n'
FENCE = "[[feature]]\nfrom = 1\nto = 2\n"
# A fence with posts on either side: it needs Steiner vertices, and which depends on who came first.
NODES = ["0,1,join,0,0", "0,2,join,1000,10"] + [
    f"{100 * n},{n},join,{80 * n},{60 + n if n % 2 else -40 - n}" for n in range(3, 13)]


class Restart(GatewayCase):
    def saved_hash(self):
        """The mesh hash of the state that is kept, as the header has it; None before the first."""
        path = self.folder / "state" / "state"
        # Its head and where the hash stands: port/posix/state_file.h, firmware/persist/saved_state.h.
        hash_at = 24 + 12
        if not path.exists():
            return None
        saved = path.read_bytes()
        return [int.from_bytes(saved[at:at + 2], "little")
                for at in range(hash_at + 6, hash_at - 2, -2)]

    def test_killed_it_serves_the_same_mesh_at_once_and_catches_up(self):
        buses = self.start_nodes(NODES)
        gateway = self.start_gateway(buses, STATE + FENCE)
        before = self.wait_for_header(nodes=12, features=1, state=0)
        wait_for("the mesh of that header in the state",
                 lambda: self.saved_hash() == before["hash"])
        gateway.stop(signal.SIGKILL)
        # Nobody answers: what it serves is what it saved.
        nodes = self.programs[0].process
        nodes.send_signal(signal.SIGSTOP)
        gateway = self.start_gateway(buses, STATE + FENCE)
        gateway.wait_for_line(r"restored the mesh of generation \d+: 12 of 12 nodes, 1 feature,")
        after = self.header()
        self.assertEqual(after["nodes"], 12)
        # All are stale; soon it also says that the bus is silent.
        self.assertIn(after["state"], (2, 2 + 16))
        self.assertEqual(after["hash"], before["hash"])
        self.assertGreater(after["generation"], before["generation"])
        nodes.send_signal(signal.SIGCONT)
        self.assertEqual(self.wait_for_header(state=0)["hash"], before["hash"])
        self.assertNotIn("joined", gateway.log())
        self.assertEqual(gateway.stop(), 0, gateway.log())

    def test_what_is_no_state_is_kept_and_the_gateway_runs(self):
        (self.folder / "state").mkdir()
        (self.folder / "state" / "state").write_text("no state at all, whatever its name says")
        buses = self.start_nodes(["0,1,join,0,0"])
        gateway = self.start_gateway(buses, STATE)
        self.wait_for_header(nodes=1, state=0)
        gateway.wait_for_line(r"state/state: is no state of a gateway; it is kept as state.refused-1")
        self.assertEqual((self.folder / "state" / "state.refused-1").read_text(),
                         "no state at all, whatever its name says")

    def test_a_disk_that_hangs_holds_up_neither_the_mesh_nor_the_end(self):
        (self.folder / "state").mkdir()
        # Opening a pipe that nobody reads takes for ever.
        os.mkfifo(self.folder / "state" / "state.new")
        buses = self.start_nodes(NODES)
        gateway = self.start_gateway(buses, STATE + FENCE)
        self.wait_for_header(nodes=12, features=1, state=0)
        # It would hang for ever.
        self.assertEqual(gateway.stop(), 0, gateway.log())
        self.assertRegex(gateway.log(), "state: the disk of .*state does not answer")
        self.assertIn("audit passed: conforming", gateway.log())

    def test_a_folder_that_cannot_be_is_said_once_and_costs_nothing_else(self):
        (self.folder / "state").write_text("in the way")
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0"]), STATE)
        self.wait_for_header(nodes=1, state=0)
        gateway.wait_for_line(r"error: state is not saved: .*state: cannot open the folder \(Not a "
                              r"directory\); .*; goes on, and tries again")
        (self.folder / "state").unlink()
        gateway.wait_for_line("state is saved again")
        self.assertEqual(gateway.log().count("state is not saved"), 1)

    def test_told_to_end_at_any_moment_of_its_start_it_ends(self):
        buses = self.start_nodes(NODES)
        for milliseconds in range(0, 60, 4):
            gateway = self.start_gateway(buses, STATE + FENCE, wait=False)
            time.sleep(milliseconds / 1000)
            # Before it listens for the signal it is ended by it.
            self.assertIn(gateway.stop(), (0, -signal.SIGTERM), gateway.log())


class Systemd(GatewayCase):
    def setUp(self):
        super().setUp()
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(self.folder / "notify"))
        self.socket.settimeout(PATIENCE_S)
        os.environ["NOTIFY_SOCKET"] = str(self.folder / "notify")
        os.environ["WATCHDOG_USEC"] = "400000"

    def tearDown(self):
        os.environ.pop("NOTIFY_SOCKET")
        os.environ.pop("WATCHDOG_USEC")
        super().tearDown()
        self.socket.close()

    def wait_for_message(self, wanted):
        while True:
            message = self.socket.recv(4096).decode()
            if message.startswith(wanted):
                return message

    def test_hears_ready_alive_how_it_is_and_stopping(self):
        gateway = self.start_gateway(self.start_nodes(NODES), FENCE)
        self.assertEqual(self.socket.recv(4096), b"READY=1")
        self.wait_for_message("WATCHDOG=1")
        status = ""
        while "12 nodes, 0 stale, 0 missing, 0 refused, 1 of 1 features" not in status:
            status = self.wait_for_message("STATUS=generation ")
        self.wait_for_message("WATCHDOG=1")
        gateway.process.send_signal(signal.SIGTERM)
        self.wait_for_message("STOPPING=1")
        self.assertEqual(gateway.stop(), 0, gateway.log())

    def test_hears_of_a_reload_and_when_it_is_done(self):
        gateway = self.start_gateway(self.start_nodes(NODES), FENCE)
        self.wait_for_message("READY=1")
        gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_message("RELOADING=1")
        self.wait_for_message("READY=1")

    def test_hears_nothing_of_a_gateway_that_stands_still(self):
        gateway = self.start_gateway(self.start_nodes(NODES))
        self.wait_for_message("WATCHDOG=1")
        gateway.process.send_signal(signal.SIGSTOP)
        self.socket.settimeout(1)
        with self.assertRaises(TimeoutError):
            while True:
                self.socket.recv(4096)
        gateway.process.send_signal(signal.SIGCONT)
        self.socket.settimeout(PATIENCE_S)
        self.wait_for_message("WATCHDOG=1")


if __name__ == "__main__":
    unittest.main(verbosity=2)
