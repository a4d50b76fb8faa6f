"""The gateway for ARM on a board with real digital lines and a serial line (board.py).

The gateway is ETCM_ARM_GATEWAY, built for the sysroot in ETCM_ARM_SYSROOT; kernel and busybox are in
ETCM_ARM_BOARD; ETCM_BIN has the programs for this machine.
"""
import os
import pathlib
import re
import time
import unittest

import gateway_test
from board import Board, LINES

CONFIG = """
[mesh]
vertices_max = 100
[poll]
interval = "1s"
timeout = "300ms"
absent_interval = "10min"
stale_after = "3s"
leave_after = "6s"
[gpio]
alert = "ALERT"
join_button = "9030000.pl061:1"
status_led = "LED"
watchdog = "WATCHDOG"
[[bus]]
name = "yard"
rtu = "/dev/ttyS0"
baud = 115200
units = "1-3,247"
[server]
listen = "0.0.0.0:1502"
allow = ["10.0.2.0/24"]
"""
SETTLED = ["0,1,join,0,0", "0,2,join,900,0", "0,3,join,0,900"]
# Units are counted as serials first appear.
ABSENT = [f"0,{serial},silent,," for serial in range(4, 247)]
# By then the default address has failed for so long that without the alert it is asked some 30
# seconds after the cable is back, and again some 60 seconds after.
NEW_AFTER_S = 35
NEW = ["0,247,silent,,", f"{1000 * NEW_AFTER_S},247,join,400,500"]
# From the alert to the new node in the registers: a probe at once, and the pause of a publication.
# Emulated, the board is some ten times slower than a real one.
JOIN_S = 5
RESIDENT_MAX_KIB = 16384


class BoardCase(gateway_test.GatewayCase):
    @classmethod
    def environment(cls, name):
        return pathlib.Path(os.environ[name]).resolve()

    def boot(self, config, **options):
        self.board = Board(self.folder, self.environment("ETCM_ARM_GATEWAY"), config,
                           self.environment("ETCM_ARM_SYSROOT"), self.environment("ETCM_ARM_BOARD"),
                           guest_port=1502, **options)
        self.addCleanup(self.board.stop)
        # Shown when a test fails.
        self.addCleanup(lambda: print(self.board.output))
        self.port = self.board.port
        # Emulated, on a machine that has other work too.
        self.board.wait_for_output("board is up", patience_s=300)

    def plug_in(self, name, rows):
        """Nodes on a terminal, and a cable from it to the board's serial port."""
        (self.folder / f"{name}.csv").write_text(
            "time_ms,serial,event,x,y\n" + "\n".join(rows) + "\n")
        far_end = self.folder / "far_end"
        nodes = self.start(name, [gateway_test.PROGRAMS / "etcm-nodes", "--rtu", far_end, "--baud",
                                  "115200", "--nodes", f"{name}.csv"])
        nodes.wait_for_line("ready:")
        cable = self.start(f"{name}_cable", ["socat", f"FILE:{far_end},raw,echo=0",
                                             f"UNIX-CONNECT:{self.board.serial_path}"])
        return nodes, cable


class OnABoard(BoardCase):
    def flashes(self):
        """The flashes of one round of the LED."""
        start = time.monotonic()
        def rounds():
            rises = self.board.rises("LED", start)
            pauses = [i for i in range(1, len(rises)) if rises[i] - rises[i - 1] > 0.7]
            return pauses[1] - pauses[0] if len(pauses) > 1 else None
        return gateway_test.wait_for("two pauses of the LED", rounds)

    def test_lines_and_serial_port(self):
        self.boot(CONFIG)
        board = self.board
        board.wait_for_output("serves the mesh on")
        self.assertEqual(self.flashes(), 5, "no nodes yet")

        first = self.plug_in("first", SETTLED + ABSENT)
        self.wait_for_header(nodes=3, triangles=1, state=0)
        self.assertEqual(self.flashes(), 1, "all well")

        for program in first:
            program.stop()
        # Stale, and the bus is silent; nobody leaves for that.
        self.wait_for_header(nodes=3, state=2 + 16)
        new_at = time.monotonic() + NEW_AFTER_S
        self.plug_in("second", SETTLED + ABSENT + NEW)
        self.wait_for_header(nodes=3, state=0)

        time.sleep(max(0, new_at + 1 - time.monotonic()))
        raised_at = time.monotonic()
        board.drive("ALERT", True)
        self.wait_for_header(nodes=4)
        self.assertLess(time.monotonic() - raised_at, JOIN_S)
        board.drive("ALERT", False)
        self.assertEqual(self.vertices()[247], (400, 500))

        board.tell("grep VmRSS /proc/$gateway/status")
        board.wait_for_output(r"VmRSS:.* kB")
        resident = int(re.search(r"VmRSS:\s+(\d+) kB", board.output)[1])
        size = self.environment("ETCM_ARM_GATEWAY").stat().st_size // 1024
        print(f"on the board: program {size} KiB, RSS {resident} KiB")
        self.assertLess(resident, RESIDENT_MAX_KIB)

        board.tell("kill -STOP $gateway")
        time.sleep(1)
        stopped_at = time.monotonic()
        time.sleep(2)
        self.assertEqual(board.rises("WATCHDOG", stopped_at), [], "fed while the loop stands still")
        board.tell("kill -CONT $gateway")
        gateway_test.wait_for("the watchdog pulse",
                              lambda: len(board.rises("WATCHDOG", stopped_at)) > 2)

        chip = "echo 9030000.pl061 > /sys/bus/amba/drivers/pl061_gpio"
        board.tell(f"{chip}/unbind")
        for name in ("ALERT", "9030000.pl061:1", "LED", "WATCHDOG"):
            board.wait_for_output(f"gpio line {name} is gone .No such device.; goes on without it")
        board.tell(f"{chip}/bind")
        for name in ("ALERT", "9030000.pl061:1", "LED", "WATCHDOG"):
            board.wait_for_output(f"gpio line {name} is there")
        self.assertEqual(self.flashes(), 1, "its chip is back")

        board.tell("kill -TERM $gateway; wait $gateway; echo status $?")
        board.wait_for_output(r"ends at generation .* 4 nodes.*audit passed")
        board.wait_for_output("status 0")
        for name in ("LED", "WATCHDOG"):
            self.assertFalse(board.levels[LINES.index(name)], f"{name} is left active")


RS485_CONFIG = """
[mesh]
vertices_max = 100
[poll]
interval = "500ms"
timeout = "300ms"
[[bus]]
name = "yard"
rtu = "/dev/ttyAMA0"
baud = 115200
units = "1-3"
[server]
listen = "0.0.0.0:1502"
allow = ["10.0.2.0/24"]
"""
# RTS is low while it sends.
DEVICE_TREE = {"linux,rs485-enabled-at-boot-time": [], "rs485-rts-active-low": [],
               "rs485-rts-delay": ["3", "5"]}


class Rs485OnABoard(BoardCase):
    """The driver of the PL011, as Debian's kernel has it: what the device tree says stays, and what
    the settings say arrives."""

    def expect_driver(self, settings):
        self.board.wait_for_news("rs485_settings /dev/ttyAMA0",
                                 f"rs485 of /dev/ttyAMA0: {re.escape(settings)}")

    def start_again(self, keys, pattern):
        """The gateway with other keys of its bus; then it says this."""
        lines = "\\n".join(["baud = 115200", *keys])
        self.board.tell("kill -TERM $gateway; wait $gateway")
        self.board.tell("cp /site.toml /other.toml")
        self.board.tell(f"sed -i 's|^baud = .*|{lines}|' /other.toml")
        self.board.wait_for_news("etcm-gateway --config /other.toml & gateway=$!", pattern)

    def test_settings_of_the_driver(self):
        self.boot(RS485_CONFIG, tools=[self.environment("ETCM_ARM_RS485_SETTINGS")],
                  rs485=DEVICE_TREE)
        self.board.wait_for_output("bus yard: opened /dev/ttyAMA0")
        self.plug_in("nodes", SETTLED)
        self.wait_for_header(nodes=3)
        of_device_tree = "enabled 1, RTS on send 0, after send 1, before 3 ms, after 5 ms"
        self.expect_driver(of_device_tree)

        opened = "bus yard: opened /dev/ttyAMA0"
        self.start_again(['rs485 = "on"'], opened)
        self.expect_driver(of_device_tree)
        self.start_again(['rs485 = "on"', 'rs485_rts = "high"', 'rs485_delay_before = "7ms"'], opened)
        self.expect_driver("enabled 1, RTS on send 1, after send 0, before 7 ms, after 5 ms")
        self.wait_for_header(nodes=3, state=0)
        self.start_again(['rs485 = "on"', 'rs485_rts = "low"', 'rs485_delay_before = "0ms"',
                          'rs485_delay_after = "2ms"'], opened)
        self.expect_driver("enabled 1, RTS on send 0, after send 1, before 0 ms, after 2 ms")
        self.wait_for_header(nodes=3, state=0)
        self.start_again(['rs485 = "off"'], opened)
        self.expect_driver("enabled 0, ")
        self.wait_for_header(nodes=3, state=0)
        # What was switched off stays so, where nothing else is said.
        self.start_again([], opened)
        self.expect_driver("enabled 0, ")

        # A driver that cannot do it is an error with the cure.
        self.board.tell("sed -i 's|/dev/ttyAMA0|/dev/ttyS1|' /site.toml")
        self.start_again(['rs485 = "on"'],
                         r"bus yard: /dev/ttyS1: its driver refuses to switch RS-485 .*take `rs485` out")


if __name__ == "__main__":
    unittest.main(verbosity=2, defaultTest=["OnABoard", "Rs485OnABoard"])
