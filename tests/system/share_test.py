"""Others on a bus of the gateway, for real: mbpoll, pymodbus and etcm-bus ask its units while it
polls them, over TCP and on a serial line. The programs' folder is in ETCM_BIN."""
import json
import pathlib
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import unittest
import urllib.request

from pymodbus.client import ModbusTcpClient

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from gateway_test import PROGRAMS, GatewayCase
from programs import PATIENCE_S, free_port, wait_for

DEVICE = HERE.parent / "profile" / "pymodbus_device.py"
NODES = ["0,7,join,300,-200", "0,8,join,-40,90", "0,9,join,5,6"]


def frame(transaction, unit, pdu):
    return struct.pack(">HHHB", transaction, 0, len(pdu) + 1, unit) + pdu


class ShareCase(GatewayCase):
    interval = "200ms"

    def share(self, more="", page=""):
        """A gateway that shares its only bus; the port of the share is in share_port."""
        gateway = self.start_gateway([], more=page + more)
        self.share_port = int(gateway.wait_for_line(r"shares bus yard on \S+:(\d+)").group(1))
        return gateway

    def over_tcp(self, keys="", page=""):
        nodes = self.start_nodes(NODES)
        gateway = self.share(f'[[bus]]\nname = "yard"\ntcp = "{nodes[0][0]}"\nunits = "1-5"\n'
                             f'timeout = "200ms"\nshare = "127.0.0.1:0"\n{keys}', page)
        self.wait_for_header(nodes=3)
        return gateway

    def on_a_line(self, keys=""):
        line = self.folder / "line"
        (self.folder / "nodes.csv").write_text("time_ms,serial,event,x,y\n" + "\n".join(NODES) + "\n")
        nodes = self.start("nodes", [PROGRAMS / "etcm-nodes", "--rtu", line, "--nodes", "nodes.csv"])
        wait_for("the line", line.exists)
        gateway = self.share(f'[[bus]]\nname = "yard"\nrtu = "{line}"\nunits = "1-5"\n'
                             f'timeout = "200ms"\nshare = "127.0.0.1:0"\n{keys}')
        self.wait_for_header(nodes=3)
        return gateway

    def mbpoll(self, *arguments):
        return subprocess.run(["mbpoll", "-m", "tcp", "-p", str(self.share_port), "-0", "-1",
                               *map(str, arguments)],
                              capture_output=True, text=True, timeout=PATIENCE_S)

    def values(self, unit, first, count):
        done = self.mbpoll("-a", unit, "-t", "3", "-r", first, "-c", count, "-o", "5", "127.0.0.1")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return [int(value) for value in re.findall(r"^\[\d+\]:\s+(\d+)", done.stdout, re.M)]

    def client(self):
        client = ModbusTcpClient("127.0.0.1", port=self.share_port, timeout=10)
        self.assertTrue(client.connect())
        self.addCleanup(client.close)
        return client

    def ask_raw(self, pdu, unit=1):
        with socket.create_connection(("127.0.0.1", self.share_port), timeout=PATIENCE_S) as link:
            link.sendall(frame(1, unit, pdu))
            return self.take(link)[2]

    def take(self, link):
        """(transaction, unit, PDU) of the next answer."""
        def take_bytes(count):
            found = b""
            while len(found) < count:
                more = link.recv(count - len(found))
                self.assertTrue(more, "hung up")
                found += more
            return found
        transaction, _, length, unit = struct.unpack(">HHHB", take_bytes(7))
        return transaction, unit, take_bytes(length - 1)


class Share(ShareCase):
    def expect_that_real_programs_read(self):
        self.assertEqual(self.values(1, 0, 4), [0x4554, 0x010C, 0, 7])
        self.assertEqual(self.values(2, 2, 2), [0, 8])
        client = self.client()
        for unit, serial in ((1, 7), (2, 8), (3, 9)):
            answer = client.read_input_registers(2, 2, slave=unit)
            self.assertFalse(answer.isError(), answer)
            self.assertEqual(answer.registers, [0, serial])
        # A unit that is not there, a register that is not, and a write.
        self.assertEqual(client.read_input_registers(0, 3, slave=5).exception_code, 0x0B)
        # An answer that a busy machine holds up for longer than the gateway waits is asked for again.
        for _ in range(4):
            code = client.read_input_registers(5000, 2, slave=1).exception_code
            if code == 2:
                break
        self.assertEqual(code, 2)
        self.assertEqual(client.write_register(200, 1, slave=1).exception_code, 1)
        for _ in range(4):
            found = self.scan()
            if len(found) == 3:
                break
        self.assertEqual(found, [7, 8, 9])

    def scan(self):
        done = subprocess.run([PROGRAMS / "etcm-bus", "scan", "-a", "1:5", "-o", "5", "--json", "-p",
                               str(self.share_port), "127.0.0.1"],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return [unit["node"]["serial"] for unit in json.loads(done.stdout)]

    def test_real_programs_read_over_tcp_while_the_gateway_polls(self):
        self.over_tcp()
        self.expect_that_real_programs_read()
        self.wait_for_header(nodes=3, state=0)

    def test_real_programs_read_on_a_serial_line_while_the_gateway_polls(self):
        self.on_a_line()
        self.expect_that_real_programs_read()
        self.wait_for_header(nodes=3, state=0)

    def test_writes_where_it_may(self):
        gateway = self.on_a_line('share_writes = true\nshare_units = "1-2"\n')
        done = self.mbpoll("-a", 1, "-t", "4", "-r", 200, "-o", "5", "127.0.0.1", "12", "13")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        gateway.wait_for_line(r"bus yard: a client at 127\.0\.0\.1 writes to unit 1")
        # A broadcast is not sent, nor is what is for a unit that is not shared.
        self.assertEqual(self.ask_raw(bytes([16, 0, 200, 0, 1, 2, 0, 9]), unit=0), b"\x90\x0a")
        self.assertEqual(self.ask_raw(bytes([16, 0, 200, 0, 1, 2, 0, 9]), unit=3), b"\x90\x0a")
        self.assertEqual(self.ask_raw(b"\x08\0\x01\0\0"), b"\x88\x01")

    def test_hostile_clients_hold_up_nobody(self):
        self.over_tcp('share_wait = "5s"\n')
        chance = random.Random(5)
        # One address has not all places.
        links = [socket.create_connection(("127.0.0.1", self.share_port),
                                          source_address=("127.0.0.2", 0)) for _ in range(6)]
        for number, link in enumerate(links):
            self.addCleanup(link.close)
            link.settimeout(PATIENCE_S)
            # Half a request; a flood that is never read; a wrong length; noise.
            link.sendall([frame(1, 1, b"\x04\0\0\0\x01")[:9],
                          frame(1, 77, b"\x04\0\0\0\x01") * 200,
                          frame(1, 1, b"\x04\0\0"),
                          struct.pack(">HHHB", 1, 0, 600, 1),
                          chance.randbytes(500),
                          frame(1, 5, b"\x04\0\0\0\x01") * 50][number])
        for _ in range(20):
            self.assertEqual(self.values(1, 2, 2), [0, 7])
        self.wait_for_header(nodes=3, state=0)

    def test_pipelined_answers_have_their_own_numbers(self):
        self.on_a_line('share_wait = "30s"\nshare_time = 50\n')
        with socket.create_connection(("127.0.0.1", self.share_port), timeout=PATIENCE_S) as link:
            asked = {}
            for turn in range(10):
                for unit, serial in ((1, 7), (2, 8), (3, 9), (1, 7)):
                    number = turn * 100 + len(asked)
                    asked[number] = (unit, serial)
                    link.sendall(frame(number, unit, struct.pack(">BHH", 4, 2, 2)))
                while asked:
                    number, unit, pdu = self.take(link)
                    self.assertEqual((unit, pdu),
                                     (asked[number][0], struct.pack(">BBI", 4, 4, asked[number][1])))
                    del asked[number]

    def test_a_reload_opens_moves_and_ends_it(self):
        gateway = self.over_tcp()
        settings = self.folder / "site.toml"
        text = settings.read_text()
        other = free_port()
        settings.write_text(text.replace('share = "127.0.0.1:0"',
                                         f'share = "127.0.0.1:{other}"\nshare_writes = true'))
        link = socket.create_connection(("127.0.0.1", self.share_port))
        link.settimeout(PATIENCE_S)
        gateway.process.send_signal(signal.SIGHUP)
        gateway.wait_for_line(rf"shares bus yard on 127\.0\.0\.1:{other} to ")
        self.assertEqual(link.recv(1), b"", "it is hung up on")
        link.close()
        self.share_port = other
        self.assertFalse(self.client().write_registers(200, [1, 1], slave=1).isError())
        settings.write_text(text.replace('share = "127.0.0.1:0"\n', ""))
        wait_for("the pause between reloads", lambda: self.reload_until(
            gateway, r"bus yard: is shared no more"))
        with self.assertRaises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", other)).close()
        self.wait_for_header(nodes=3, state=0)

    def reload_until(self, gateway, line):
        gateway.process.send_signal(signal.SIGHUP)
        return re.search(line, gateway.log())

    def test_metrics_tell_of_it(self):
        gateway = self.over_tcp(page='[http]\nlisten = "127.0.0.1:0"\n')
        url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        client = self.client()
        client.read_input_registers(2, 2, slave=1)
        client.read_input_registers(2, 2, slave=5)
        client.write_register(1, 1, slave=1)
        with urllib.request.urlopen(url + "/metrics", timeout=30) as answer:
            text = answer.read().decode()
        for line in ('etcm_share_listening{bus="yard"} 1', 'etcm_share_clients{bus="yard"} 1',
                     'etcm_share_requests_total{bus="yard",result="answered"} 1',
                     'etcm_share_requests_total{bus="yard",result="no_answer"} 1',
                     'etcm_share_refused_total{bus="yard"} 1'):
            self.assertIn("\n" + line + "\n", text)

    def test_a_bus_without_a_connection_is_no_path(self):
        self.share(f'[[bus]]\nname = "yard"\ntcp = "127.0.0.1:{free_port()}"\nunits = "1"\n'
                   'share = "127.0.0.1:0"\n')
        self.assertEqual(self.client().read_input_registers(0, 1, slave=1).exception_code, 0x0A)

    WRITES = "share = \"127.0.0.1:0\"\nshare_writes = true\nshare_time = 50\nshare_wait = \"9s\"\n"
    DEVICE_REGISTERS = json.dumps({"5": {"3": {str(at): at for at in range(20)}}})

    def expect_that_a_device_takes_writes(self, masks):
        client = self.client()
        wait_for("the device", lambda: not client.read_holding_registers(0, 1, slave=5).isError())
        self.assertFalse(client.write_register(3, 700, slave=5).isError())
        self.assertFalse(client.write_registers(4, [800, 900], slave=5).isError())
        # The client of this pymodbus cannot send FC 22 and FC 23.
        if masks:
            mask = bytes([22, 0, 5, 0xFF, 0, 0, 1])
            self.assertEqual(self.ask_raw(mask, unit=5), mask)
        last = 900 & 0xFF00 | 1 if masks else 900
        self.assertEqual(self.ask_raw(bytes([23, 0, 3, 0, 3, 0, 6, 0, 1, 2, 0, 77]), unit=5),
                         struct.pack(">BB3H", 23, 6, 700, 800, last))
        self.assertEqual(client.read_holding_registers(6, 1, slave=5).registers, [77])

    def test_a_device_on_a_line_takes_writes(self):
        near, far = self.folder / "near", self.folder / "far"
        self.start("line", ["socat", f"pty,raw,echo=0,link={near}", f"pty,raw,echo=0,link={far}"])
        wait_for("the line", lambda: near.exists() and far.exists())
        self.start("device", [sys.executable, DEVICE, far, self.DEVICE_REGISTERS])
        self.share(f'[[bus]]\nname = "yard"\nrtu = "{near}"\nbaud = 9600\nparity = "none"\n'
                   f'units = "6"\ntimeout = "1s"\n{self.WRITES}')
        # pymodbus's own serial server does not know how long FC 22 is.
        self.expect_that_a_device_takes_writes(masks=False)

    def test_a_device_over_tcp_takes_writes(self):
        port = free_port()
        self.start("device", [sys.executable, DEVICE, port, self.DEVICE_REGISTERS])
        self.share(f'[[bus]]\nname = "yard"\ntcp = "127.0.0.1:{port}"\nunits = "6"\n'
                   f'timeout = "1s"\n{self.WRITES}')
        self.expect_that_a_device_takes_writes(masks=True)

    def test_a_device_behind_a_serial_server_takes_writes(self):
        port = free_port()
        self.start("device", [sys.executable, DEVICE, f"rtu:{port}", self.DEVICE_REGISTERS])
        self.share(f'[[bus]]\nname = "yard"\ntcp = "127.0.0.1:{port}"\nframing = "rtu"\n'
                   f'units = "6"\ntimeout = "1s"\n{self.WRITES}')
        self.expect_that_a_device_takes_writes(masks=False)


if __name__ == "__main__":
    unittest.main(defaultTest="Share")
