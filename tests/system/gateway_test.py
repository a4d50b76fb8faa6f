"""The gateway run for real: against etcm-nodes (over TCP and on a serial line), against pymodbus,
and read by mbpoll.

The programs' folder is in ETCM_BIN.
"""
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import unittest
import urllib.error
import urllib.request

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "support"))
from programs import PATIENCE_S, ProgramCase, free_port, wait_for

PROGRAMS = pathlib.Path(os.environ["ETCM_BIN"]).resolve()


# For what falls silent. Everywhere else a pause of a busy machine must be no silence.
SOON = {"stale_after": "1s", "leave_after": "2s"}


class GatewayCase(ProgramCase):
    vertices_max = 1000
    interval = "100ms"

    def start_nodes(self, rows, listen="127.0.0.1:0", name="nodes"):
        (self.folder / f"{name}.csv").write_text(
            "time_ms,serial,event,x,y\n" + "\n".join(rows) + "\n")
        nodes = self.start(name, [PROGRAMS / "etcm-nodes", "--listen", listen,
                                  "--nodes", f"{name}.csv"])
        nodes.wait_for_line(r"ready:")
        return re.findall(r"listens on (\S+) for units (\S+)", nodes.log())

    def start_gateway(self, buses, more="", head="", stale_after="20s", leave_after="60s",
                      listen="127.0.0.1:0", wait=True):
        config = head + f"""
[mesh]
vertices_max = {self.vertices_max}
features_max = 50
[poll]
interval = "{self.interval}"
timeout = "500ms"
absent_interval = "{self.interval}"
stale_after = "{stale_after}"
leave_after = "{leave_after}"
[server]
listen = "{listen}"
[files]
folder = "out"
interval = "100ms"
[control]
socket = "control"
"""
        for address, units in buses:
            link = "rtu" if address.startswith("/") else "tcp"
            config += f'[[bus]]\n{link} = "{address}"\nunits = "{units}"\n'
        (self.folder / "site.toml").write_text(config + more)
        gateway = self.start("gateway", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        if not wait:
            return gateway
        match = gateway.wait_for_line(r"serves the mesh on \S+:(\d+)")
        self.port = int(match.group(1))
        return gateway

    def ctl(self, *words):
        return subprocess.run([PROGRAMS / "etcm-gateway", "ctl", "--socket", "control", *words],
                              cwd=self.folder, capture_output=True, text=True, timeout=PATIENCE_S)

    def read(self, unit, first, count):
        """Input registers, read by mbpoll."""
        done = subprocess.run(
            ["mbpoll", "-m", "tcp", "-p", str(self.port), "-a", str(unit), "-t", "3", "-0", "-r",
             str(first), "-c", str(count), "-1", "127.0.0.1"],
            capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return [int(value) for value in re.findall(r"^\[\d+\]:\s+(\d+)", done.stdout, re.M)]

    def header(self):
        registers = self.read(1, 0, 44)
        long = lambda at: registers[at] << 16 | registers[at + 1]
        return {"generation": long(0), "magic": registers[2], "state": registers[4],
                "nodes": long(10), "steiner": long(12), "triangles": long(16),
                "features": long(18), "quarantined": long(22), "vertex_rows": long(28),
                "vertex_block": long(30), "neighbour_block": long(36),
                "hash": registers[40:44]}

    def wait_for_header(self, **wanted):
        def matches():
            header = self.header()
            return header if all(header[key] == value for key, value in wanted.items()) else None
        return wait_for(f"a header with {wanted}", matches)

    def wait_until_silent(self):
        """Until no node of a bus answers. On a busy machine a node may have been missing before."""
        wait_for("a bus that is silent", lambda: self.header()["state"] & 16)

    def vertices(self):
        """{serial: (x, y)} of the nodes, from the vertex blocks."""
        header = self.header()
        found = {}
        for row in range(header["vertex_rows"]):
            block = header["vertex_block"] + row // 7
            at = block * 120 + 2 + row % 7 * 16
            vertex = self.read(1, at, 16)
            signed = lambda high: (vertex[high] << 16 | vertex[high + 1]) - (
                vertex[high] >> 15 << 32)
            if vertex[0] & 0xFF == 1:
                found[vertex[2] << 16 | vertex[3]] = (signed(6), signed(10))
        return found


THREE = ["0,1,join,0,0", "0,2,join,1000,-5", "0,3,join,400,700"]


class AgainstNodes(GatewayCase):
    def test_nodes_join_move_fall_silent_and_leave(self):
        buses = self.start_nodes(["0,1,join,0,0", "0,2,join,1000,-5", "0,3,join,400,700",
                                  "4000,4,join,500,300", "8000,3,move,450,750",
                                  "12000,1,silent,,", "12000,4,leave,,"])
        gateway = self.start_gateway(buses, "[[feature]]\nfrom = 1\nto = 2\n", **SOON)
        self.assertEqual(self.header()["magic"], 0x4D45)
        gateway.wait_for_line(r"node 4 joined at \(500, 300\): \d nodes, \d+ proposed relays?|joined at \(500, 300\): \d nodes")
        gateway.wait_for_line(r"node 3 moved from \(400, 700\) to \(450, 750\)")
        gateway.wait_for_line(r"node 4 left \(on its own request\)")
        gateway.wait_for_line(r"node 1 left \(silent\)")
        gateway.wait_for_line(r"node 1 is missing: unit 1 of ")
        # Partial, for the feature waits, and missing.
        self.wait_for_header(nodes=2, features=0, state=1 + 8)
        self.assertEqual(self.vertices(), {2: (1000, -5), 3: (450, 750)})
        done = self.ctl("dismiss", "1")
        self.assertEqual((done.returncode, done.stdout), (0, "node 1 is no longer missed\n"))
        gateway.wait_for_line(r"node 1 is no longer missed: dismissed")
        self.wait_for_header(nodes=2, state=1)

    def test_nodes_are_reached_by_name_and_by_ipv6_beside_a_name_that_is_not_there(self):
        [(named, _)] = self.start_nodes(["0,1,join,0,0"], name="named")
        [(ipv6, _)] = self.start_nodes(["0,2,join,1000,-5"], listen="[::1]:0", name="ipv6")
        gateway = self.start_gateway(
            [(named.replace("127.0.0.1", "localhost"), "1"), (ipv6, "1"),
             ("no-such-host.invalid:502", "1")], listen="[::]:0")
        gateway.wait_for_line(r"no-such-host\.invalid:502: .*correct the name.*trying again")
        self.wait_for_header(nodes=2)
        self.assertEqual(gateway.stop(), 0, gateway.log())
        self.assertEqual(gateway.log().count("correct the name"), 1)

    def test_a_gateway_that_was_stopped_expels_nobody(self):
        gateway = self.start_gateway(self.start_nodes(THREE), **SOON)
        self.wait_for_header(nodes=3, state=0)
        gateway.process.send_signal(signal.SIGSTOP)
        time.sleep(8)
        gateway.process.send_signal(signal.SIGCONT)
        # What it does on a signal it does after it has looked for who is silent.
        gateway.process.send_signal(signal.SIGHUP)
        gateway.wait_for_line("is read again")
        self.wait_for_header(nodes=3, state=0)
        for nobody in ("left", "is missing"):
            self.assertNotIn(nobody, gateway.log())

    def test_a_bus_that_is_silent_expels_nobody(self):
        gateway = self.start_gateway(self.start_nodes(THREE), **SOON)
        self.wait_for_header(nodes=3, state=0)
        nodes = self.programs[0].process
        nodes.send_signal(signal.SIGSTOP)
        gateway.wait_for_line(r"bus \S+: silent for \d+ s, none of its 3 nodes answers")
        time.sleep(6)
        self.wait_for_header(nodes=3, state=2 + 16)
        nodes.send_signal(signal.SIGCONT)
        gateway.wait_for_line(r"bus \S+: answers again, after \d+ s")
        self.wait_for_header(nodes=3, state=0)
        for nobody in ("left", "is missing"):
            self.assertNotIn(nobody, gateway.log())

    def test_sigterm_ends_it_with_complete_files(self):
        buses = self.start_nodes([f"0,{n},join,{n * n % 97},{n * 7 % 101}" for n in range(1, 31)])
        gateway = self.start_gateway(buses)
        self.wait_for_header(nodes=30)
        self.assertEqual(gateway.stop(signal.SIGTERM), 0, gateway.log())
        self.assertIn("30 nodes", gateway.log())
        self.assertIn("audit passed: conforming", gateway.log())
        out = self.folder / "out"
        self.assertEqual(sorted(path.name for path in out.iterdir() if path.name != ".mesh.lock"),
                         ["mesh.ele", "mesh.node", "mesh.svg"])
        records = [line.split() for line in (out / "mesh.node").read_text().splitlines()
                   if line.strip() and not line.startswith("#")]
        self.assertEqual(int(records[0][0]), 30)
        self.assertEqual({int(record[3]) for record in records[1:31]}, set(range(1, 31)))

    def test_sigint_ends_it_too(self):
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        self.wait_for_header(nodes=1)
        self.assertEqual(gateway.stop(signal.SIGINT), 0, gateway.log())

    def test_hundreds_of_nodes_on_several_ports(self):
        count = 600
        buses = self.start_nodes([f"0,{n},join,{n * 37 % 1009},{n * n % 997}"
                                  for n in range(1, count + 1)])
        self.assertEqual([units for _, units in buses], ["1-247", "1-247", "1-106"])
        self.start_gateway(buses)
        self.wait_for_header(nodes=count, state=0)

    def test_sighup_takes_another_configuration_over_or_leaves_all_as_it_is(self):
        def site(*lines):
            features = ",".join(
                '{"type":"Feature","properties":null,"geometry":'
                '{"type":"LineString","coordinates":%s}}' % line for line in lines)
            (self.folder / "site.geojson").write_text(
                '{"type":"FeatureCollection","features":[%s]}' % features)

        def reread(expected):
            seen = gateway.log().count(expected)
            gateway.process.send_signal(signal.SIGHUP)
            wait_for(expected, lambda: gateway.log().count(expected) > seen)

        site("[[0,0],[90,0]]")
        gateway = self.start_gateway(self.start_nodes(["0,1,join,10,50", "0,2,join,70,60"]),
                                     head='[site]\nfile = "site.geojson"\ncrs = "plane"\n')
        self.wait_for_header(nodes=2, features=1, state=0)
        site("[[0,0],[90,0],[90,90]]", "[[0,0],[-20,40]]")
        reread("is read again: 3 segments")
        self.wait_for_header(nodes=2, features=3, state=0)
        for broken in ("[[0,0],[90,0.5]]", "[[0,0],[90,0]"):
            site(broken)
            reread("the old one stays")
        (self.folder / "site.geojson").unlink()
        reread("the old one stays")
        self.assertRegex(gateway.log(), r"site\.geojson:1: features/0/geometry/coordinates/1: y 0\.5")
        self.wait_for_header(nodes=2, features=3, state=0)
        site("[[0,0],[90,0]]")
        for _ in range(2):
            gateway.process.send_signal(signal.SIGHUP)
        self.wait_for_header(nodes=2, features=1, state=0)
        config = self.folder / "site.toml"
        config.write_text(config.read_text().replace("vertices_max = 1000", "vertices_max = 2000"))
        reread("needs a restart: [mesh] vertices_max")
        self.assertEqual(gateway.stop(), 0, gateway.log())
        self.assertIn("audit passed", gateway.log())

    def test_units_and_buses_may_be_added_by_a_reload(self):
        [(yard, _)] = self.start_nodes(["0,1,join,0,0", "0,2,join,70,60", "0,3,join,30,90"])
        [(gate, _)] = self.start_nodes(["0,4,join,80,0", "0,5,join,-20,40"], name="gate")
        gateway = self.start_gateway([(yard, "1-2")], '[http]\nlisten = "127.0.0.1:0"\n')
        self.wait_for_header(nodes=2)
        page = gateway.wait_for_line(r"shows the status page on (http://\S+)").group(1)
        config = self.folder / "site.toml"
        config.write_text(config.read_text().replace('"1-2"', '"1-3"')
                          + f'[[bus]]\ntcp = "{gate}"\nunits = "1-2"\n')
        gateway.process.send_signal(signal.SIGHUP)
        gateway.wait_for_line("is read again: .*, 3 units more than before")
        self.wait_for_header(nodes=5, state=0)
        self.assertEqual(set(self.vertices()), {1, 2, 3, 4, 5})
        for document in ("status.json", "metrics"):
            with urllib.request.urlopen(f"{page.rstrip('/')}/{document}", timeout=60) as answer:
                self.assertIn(gate, answer.read().decode())
        self.assertEqual(gateway.log().count(f"connected to {yard}"), 1)
        config.write_text(config.read_text().replace('"1-3"', '"2-3"'))
        gateway.process.send_signal(signal.SIGHUP)
        gateway.wait_for_line(r"needs a restart: \[\[bus\]\] units")
        self.assertEqual(gateway.stop(), 0, gateway.log())
        self.assertIn("audit passed", gateway.log())

    def test_each_reload_is_answered_in_the_log_however_many_there_were(self):
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        config = self.folder / "site.toml"
        good = config.read_text()
        for expected, text in (("is read again", good), ("the old one stays", good + "wrong = 1\n")):
            config.write_text(text)
            for count in range(1, 8):
                gateway.process.send_signal(signal.SIGHUP)
                wait_for(f"answer {count}: {expected}",
                         lambda: gateway.log().count(expected) == count)
        self.assertEqual(gateway.log().count("'wrong' is unknown"), 7)

    def test_unreadable_blocks_are_exceptions_and_harm_nobody(self):
        self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        self.wait_for_header(nodes=1)
        for unit, first in ((1, 65500), (9, 0)):
            done = subprocess.run(
                ["mbpoll", "-m", "tcp", "-p", str(self.port), "-a", str(unit), "-t", "3", "-0",
                 "-r", str(first), "-c", "30", "-1", "127.0.0.1"], capture_output=True, text=True)
            self.assertIn("Illegal data address", done.stdout + done.stderr)
        write = subprocess.run(["mbpoll", "-m", "tcp", "-p", str(self.port), "-a", "1", "-t", "4",
                                "-0", "-r", "0", "127.0.0.1", "7"], capture_output=True, text=True)
        self.assertIn("Illegal function", write.stdout + write.stderr)
        self.wait_for_header(nodes=1)


class NewNodes(GatewayCase):
    def holding(self, port, unit, first, count):
        done = subprocess.run(
            ["mbpoll", "-m", "tcp", "-p", port, "-a", str(unit), "-t", "4", "-0", "-r", str(first),
             "-c", str(count), "-1", "127.0.0.1"], capture_output=True, text=True, timeout=PATIENCE_S)
        return [int(value) for value in re.findall(r"^\[\d+\]:\s+(\d+)", done.stdout, re.M)]

    def test_they_are_given_units_and_all_are_told_their_neighbours(self):
        # Two wait at the default unit at once, a third is where nobody has listed it.
        buses = self.start_nodes(["0,1,join,0,0", "0,2,join,900,0", "0,2,unit,247,",
                                  "0,3,join,400,700", "0,3,unit,247,", "0,4,join,450,-700",
                                  "0,4,unit,40,"])
        address = buses[0][0]
        gateway = self.start_gateway(
            [(address, "1")],
            'assign = "10-12"\nscan = "38-42"\n[write_back]\nenabled = true\n')
        self.wait_for_header(nodes=4, state=0)
        units = {int(gateway.wait_for_line(rf"node {serial} has unit (1[0-2]) of").group(1))
                 for serial in (2, 3)}
        self.assertEqual(units, {10, 11})
        port = address.split(":")[1]
        told = lambda: self.holding(port, 1, 200, 9)[2:] == [3, 0, 2, 0, 3, 0, 4]
        wait_for("the neighbours of node 1 in its registers", told)
        told = lambda: self.holding(port, 40, 200, 7)[2:] == [2, 0, 1, 0, 2]
        wait_for("the neighbours of node 4 in its registers", told)
        self.assertEqual(gateway.stop(), 0, gateway.log())

    def test_a_copied_serial_is_an_alarm_and_the_first_stays(self):
        buses = self.start_nodes(["0,1,join,0,0", "0,2,join,90,0", "2000,1,twin,50,50"])
        gateway = self.start_gateway([(buses[0][0], "1-3")])
        gateway.wait_for_line(r"two nodes with serial 1: unit 1 of \S+ and unit 3 of")
        self.wait_for_header(nodes=2, quarantined=1, state=1)
        self.assertEqual(self.vertices(), {1: (0, 0), 2: (90, 0)})


class AgainstPymodbus(GatewayCase):
    def start_peer(self, port, *nodes):
        return self.start("peer", [sys.executable, HERE / "pymodbus_nodes.py", port, *nodes])

    def test_an_independent_server_is_read_and_absent_units_do_no_harm(self):
        port = free_port()
        self.start_peer(port, "70001,-3,4", "70002,100,0", "70003,0,100")
        self.start_gateway([(f"127.0.0.1:{port}", "1-6")])
        self.wait_for_header(nodes=3, triangles=1)
        self.assertEqual(self.vertices(), {70001: (-3, 4), 70002: (100, 0), 70003: (0, 100)})

    def test_it_comes_back_after_the_peer_was_gone(self):
        port = free_port()
        peer = self.start_peer(port, "1,0,0", "2,100,0")
        gateway = self.start_gateway([(f"127.0.0.1:{port}", "1-2")], **SOON)
        self.wait_for_header(nodes=2)
        peer.stop(signal.SIGKILL)
        self.wait_until_silent()
        self.start_peer(port, "1,0,0", "2,100,50")
        self.wait_for_header(nodes=2, state=0)
        gateway.wait_for_line(r"node 2 (moved from .* to|joined at) \(100, 50\)")


    def test_an_independent_client_learns_who_the_gateway_is(self):
        from pymodbus.client import ModbusTcpClient
        from pymodbus.mei_message import ReadDeviceInformationRequest
        self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        client = ModbusTcpClient("127.0.0.1", port=self.port)
        self.assertTrue(client.connect())
        answer = client.execute(ReadDeviceInformationRequest(unit=1, slave=1))
        client.close()
        self.assertEqual(answer.information[0], b"ETCM")
        self.assertEqual(answer.information[1], b"etcm-gateway")


class Converter(threading.Thread):
    """Modbus TCP in, one serial line out: one queue, 30 ms a unit, and a unit that is not there holds
    it for a second, then exception 0x0B."""

    def __init__(self, units):
        super().__init__(daemon=True)
        self.units = units
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self.listener.getsockname()[1]
        self.start()

    def close(self):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()

    def run(self):
        while True:
            try:
                master, _ = self.listener.accept()
            except OSError:
                return
            with master, master.makefile("rb") as requests:
                try:
                    self.serve(master, requests)
                except OSError:
                    pass

    def serve(self, master, requests):
        while len(request := requests.read(12)) == 12:
            transaction, _, _, unit, function, first, count = struct.unpack(">HHHBBHH", request)
            if unit in self.units:
                time.sleep(0.03)
                pdu = bytes([function, 2 * count]) + struct.pack(
                    ">12H", 0x4554, 0x010C, 0, unit, 7, 0, 10 * unit, 0, unit * unit, 1, 0, 7)[
                        2 * first:2 * (first + count)]
            else:
                time.sleep(1)
                pdu = bytes([function | 0x80, 0x0B])
            master.sendall(struct.pack(">HHHB", transaction, 0, len(pdu) + 1, unit) + pdu)


class BehindAConverter(GatewayCase):
    def test_twenty_units_and_a_dead_one_join_with_the_default_settings(self):
        converter = Converter(range(1, 21))
        self.addCleanup(converter.close)
        (self.folder / "site.toml").write_text(
            f'[mesh]\nvertices_max = 100\n[server]\nlisten = "127.0.0.1:0"\n'
            f'[[bus]]\ntcp = "{converter.address}"\nunits = "1-21"\n')
        gateway = self.start("gateway", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        self.port = int(gateway.wait_for_line(r"serves the mesh on \S+:(\d+)").group(1))
        self.wait_for_header(nodes=20)
        gateway.wait_for_line(
            r'unit 21 was answered for too late, after \d+ ms.*outstanding = 1.*timeout = "\d+ms"')
        self.assertEqual(gateway.stop(), 0, gateway.log())


class OnASerialLine(GatewayCase):
    def start_line(self, rows, name="line"):
        (self.folder / f"{name}.csv").write_text(
            "time_ms,serial,event,x,y\n" + "\n".join(rows) + "\n")
        path = str(self.folder / "cable")
        nodes = self.start(name, [PROGRAMS / "etcm-nodes", "--rtu", path, "--baud", "115200",
                                  "--nodes", f"{name}.csv"])
        nodes.wait_for_line(r"ready:")
        return path, nodes

    def start_gateway(self, path, units, **times):
        return super().start_gateway([(path, units)], more='baud = 115200\ntimeout = "300ms"\n',
                                     **times)

    def test_units_that_misbehave_cost_their_own_time_only(self):
        # So late that no pause of the gateway takes it for an answer in time.
        faults = ["silent", "exception,4,", "torn", "late,2000,", "garbled", "truncated",
                  "wrong_unit", "noise"]
        rows = [f"0,{serial},join,{100 * serial},{serial * serial}" for serial in range(1, 21)]
        # What is silent or wrong from the start is never in the mesh; noise before an answer is
        # no fault of the answer.
        rows += [f"0,{serial},{fault}{'' if ',' in fault else ',,'}"
                 for serial, fault in enumerate(faults, start=13)]
        path, _ = self.start_line(rows)
        gateway = self.start_gateway(path, "1-20")
        self.wait_for_header(nodes=13)
        gateway.wait_for_line(r"unit 16 answered too late, after \d+ ms")
        expected = {serial: (100 * serial, serial * serial) for serial in [*range(1, 13), 20]}
        self.assertEqual(self.vertices(), expected)
        self.assertEqual(gateway.stop(), 0)
        self.assertRegex(gateway.log(), r"13 nodes.*audit passed")

    def test_a_unit_that_answers_late_is_not_believed_and_joins_with_the_timeout_that_the_log_names(self):
        path, _ = self.start_line(["0,1,join,10,20", "0,1,late,1350,"])

        def start(name, more):
            (self.folder / f"{name}.toml").write_text(
                f'[mesh]\nvertices_max = 10\n[server]\nlisten = "127.0.0.1:0"\n'
                f'[http]\nlisten = "127.0.0.1:0"\n'
                f'[[bus]]\nrtu = "{path}"\nbaud = 115200\nunits = "1"\n{more}')
            return self.start(name, [PROGRAMS / "etcm-gateway", "--config", f"{name}.toml"])

        gateway = start("defaults", "")
        page = gateway.wait_for_line(r"status page on (http://\S+)").group(1)

        def asked():
            with urllib.request.urlopen(page + "/metrics", timeout=PATIENCE_S) as answer:
                text = answer.read().decode()
            return int(re.search(r"^etcm_unit_requests_total.* (\d+)$", text, re.M).group(1))

        wait_for("ten questions", lambda: asked() >= 10)
        said = gateway.wait_for_line(
            r'unit 1 answered too late, after (\d+) ms.* units = "1" and timeout = "(\d+)ms"')
        self.assertEqual(gateway.stop(), 0)
        self.assertNotIn("joined", gateway.log())
        self.assertGreaterEqual(int(said.group(1)), 1350)
        patient = start("patient", f'[[bus.device]]\nunits = "1"\ntimeout = "{said.group(2)}ms"\n')
        patient.wait_for_line(r"node 1 joined at \(10, 20\)")
        self.assertEqual(patient.stop(), 0)

    def test_new_nodes_are_given_units_and_looked_for(self):
        path, _ = self.start_line(["0,1,join,0,0", "0,2,join,90,0", "0,2,unit,247,",
                                   "0,3,join,0,90", "0,3,unit,247,", "0,4,join,80,80",
                                   "0,4,unit,40,"])
        gateway = super().start_gateway(
            [(path, "1")], more='baud = 115200\ntimeout = "300ms"\nassign = "10-12"\n'
            'scan = "38-42"\n[write_back]\nenabled = true\n')
        self.wait_for_header(nodes=4, state=0)
        for serial in (2, 3):
            gateway.wait_for_line(rf"node {serial} has unit 1[0-2] of")
        self.assertEqual(gateway.stop(), 0, gateway.log())
        self.assertNotIn("not told", gateway.log())

    def test_a_pulled_cable_is_back_within_two_polls(self):
        rows = ["0,1,join,0,0", "0,2,join,90,0", "0,3,join,0,90"]
        path, nodes = self.start_line(rows)
        gateway = self.start_gateway(path, "1-3", **SOON)
        self.wait_for_header(nodes=3)
        # Left where it is, it would soon lead to the terminal of somebody else.
        pathlib.Path(path).unlink()
        nodes.stop(signal.SIGKILL)
        gateway.wait_for_line(r"cable: .*; trying again")
        self.wait_until_silent()
        self.start_line(["0,1,join,0,0", "0,2,join,90,0", "0,3,join,0,95"], name="again")
        self.wait_for_header(nodes=3, state=0)
        gateway.wait_for_line(r"node 3 (moved from .* to|joined at) \(0, 95\)")

    def test_a_line_has_one_master(self):
        path, _ = self.start_line(["0,1,join,0,0"])
        self.start_gateway(path, "1")
        self.wait_for_header(nodes=1)
        other = self.start("other", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        other.wait_for_line(r"another program has it; end that one")


class CommandLine(GatewayCase):
    def run_gateway(self, *arguments):
        return subprocess.run([PROGRAMS / "etcm-gateway", *arguments], capture_output=True,
                              text=True, timeout=PATIENCE_S, cwd=self.folder)

    def test_check_config_says_good_or_names_each_mistake(self):
        good = '[mesh]\nvertices_max = 9\n[[bus]]\ntcp = "127.0.0.1:1"\nunits = "1"\n'
        (self.folder / "site.toml").write_text(good)
        done = self.run_gateway("--config", "site.toml", "--check-config")
        self.assertEqual((done.returncode, done.stdout), (0, "site.toml: good\n"), done.stderr)
        (self.folder / "site.toml").write_text('[site]\nfile = "no.poly"\n' + good + "unit = 3\n")
        done = self.run_gateway("--config", "site.toml", "--check-config")
        self.assertEqual(done.returncode, 2)
        self.assertIn("site.toml:8: 'unit' is unknown in [[bus]]; did you mean 'units'?", done.stderr)
        self.assertIn("no.poly", done.stderr)

    def test_what_works_worse_than_meant_is_a_warning(self):
        (self.folder / "site.toml").write_text(
            '[mesh]\nvertices_max = 9\n[[bus]]\ntcp = "127.0.0.1:1"\nunits = "1-10"\n'
            '[server]\nlisten = "127.0.0.1:0"\n')
        done = self.run_gateway("--config", "site.toml", "--check-config")
        self.assertEqual((done.returncode, done.stdout), (0, "site.toml: good\n"), done.stderr)
        self.assertIn("warning: site.toml:2: the buses have 10 units", done.stderr)
        gateway = self.start("gateway", [PROGRAMS / "etcm-gateway", "--config", "site.toml"])
        gateway.wait_for_line(r"warning: site.toml:2: the buses have 10 units")
        # From here on it ends when it is told to, and not by the signal itself.
        gateway.wait_for_line(r"serves the mesh on 127\.0\.0\.1:")
        self.assertEqual(gateway.stop(), 0, gateway.log())

    def test_what_systemd_gives_to_the_service_alone_is_not_missed_by_a_check(self):
        credential = "/run/credentials/etcm-gateway-of-a-test.service/mqtt.password"
        config = ('[mesh]\nvertices_max = 9\n[[bus]]\ntcp = "127.0.0.1:1"\nunits = "1"\n'
                  '[mqtt]\nbroker = "127.0.0.1:9"\n'
                  f'site = "yard"\nname = "north"\npassword_file = "{credential}"\n')
        (self.folder / "site.toml").write_text(config)
        done = self.run_gateway("--config", "site.toml", "--check-config")
        self.assertEqual((done.returncode, done.stdout), (0, "site.toml: good\n"), done.stderr)
        self.assertIn(f"warning: site.toml:10: {credential} is not looked at: systemd gives it to "
                      "the service alone, and only while that runs", done.stderr)
        # The service would have it; who starts it by hand has not.
        done = self.run_gateway("--config", "site.toml")
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"there is no {credential}; name it in a LoadCredential of the service",
                      done.stderr)
        # Other mistakes are found all the same.
        (self.folder / "site.toml").write_text(config + 'nonsense = 1\n')
        self.assertEqual(self.run_gateway("--config", "site.toml", "--check-config").returncode, 2)

    def test_the_settings_it_prints_are_good_as_they_stand(self):
        printed = self.run_gateway("--settings")
        self.assertEqual(printed.returncode, 0, printed.stderr)
        (self.folder / "site.toml").write_text(printed.stdout)
        done = self.run_gateway("--config", "site.toml", "--check-config")
        self.assertEqual((done.returncode, done.stdout), (0, "site.toml: good\n"), done.stderr)

    def test_the_manual_page_has_each_key_of_the_settings(self):
        table = self.run_gateway("--settings-table").stdout
        man = HERE.parents[1] / "firmware/man"
        page = subprocess.run(["awk", "-f", man / "settings.awk", man.parent / "guide/settings.md"],
                              capture_output=True, text=True, timeout=PATIENCE_S, check=True).stdout
        keys = re.findall(r"^\| (?:\*\*)?`([^`]+)`", table, re.M)
        self.assertGreater(len(keys), 50)
        self.assertEqual(re.findall(r"^\.(?:Ss|It) \\fB([^\\]+)\\fR", page, re.M), keys)

    def test_the_example_of_the_manual_page_is_good_as_it_stands(self):
        man = HERE.parents[1] / "firmware/man"
        page = subprocess.run(["awk", "-f", man / "settings.awk", man.parent / "guide/settings.md"],
                              capture_output=True, text=True, timeout=PATIENCE_S, check=True).stdout
        example = re.search(r"^\.Sh EXAMPLES\n.*?^\.Bd -literal\n(.*?)^\.Ed", page, re.M | re.S)
        (self.folder / "site.toml").write_text(example.group(1).replace("\\-", "-"))
        done = self.run_gateway("--config", "site.toml", "--check-config")
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)

    def test_each_manual_page_ends_with_examples(self):
        pages = sorted(HERE.parents[1].glob("tools/*/*.[1-9]")) + [
            HERE.parents[1] / "firmware/man/etcm-gateway.8"]
        self.assertGreater(len(pages), 3)
        for page in pages:
            self.assertIn("\n.Sh EXAMPLES\n", page.read_text(), page)

    def test_wrong_settings_are_errors_of_the_log_too(self):
        (self.folder / "site.toml").write_text("[poll]\n")
        done = self.run_gateway("--config", "site.toml")
        self.assertEqual(done.returncode, 2)
        self.assertIn("error: site.toml:1: 'mesh' is missing", done.stderr)

    def test_a_wrong_command_line_is_status_2_and_the_version_is_told(self):
        for arguments in (["site.toml"], ["--check-config"], ["--config"], []):
            self.assertEqual(self.run_gateway(*arguments).returncode, 2, arguments)
        done = self.run_gateway("--version")
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stdout, r"^etcm-gateway \d+\.\d+\.\d+\n$")

    def test_it_has_the_profiles_that_were_installed_beside_it(self):
        program = PROGRAMS / "etcm-gateway"
        if program.read_bytes()[:4] != b"\x7fELF":
            self.skipTest("what runs it here stays where it is")
        (self.folder / "bin").mkdir()
        shutil.copy(program, self.folder / "bin")
        (self.folder / "site.toml").write_text(
            '[mesh]\nvertices_max = 9\n[[bus]]\ntcp = "127.0.0.1:1"\n'
            '[[bus.device]]\nprofile = "transmitter"\nunits = "1"\n')
        check = [self.folder / "bin" / "etcm-gateway", "--config", "site.toml", "--check-config"]
        run = lambda: subprocess.run(check, capture_output=True, text=True, timeout=PATIENCE_S,
                                     cwd=self.folder)
        self.assertIn("there is no profile 'transmitter'", run().stderr)
        shutil.copytree(HERE.parents[1] / "firmware" / "profiles",
                        self.folder / "share" / "etcm" / "profiles")
        done = run()
        self.assertEqual((done.returncode, done.stdout), (0, "site.toml: good\n"), done.stderr)

    def test_a_site_file_brings_its_features(self):
        (self.folder / "site.poly").write_text(
            "3 2 0 0\n1 0 0\n2 9 0\n3 0 9\n2 0\n1 1 2\n2 2 3\n0\n")
        buses = self.start_nodes(["0,1,join,0,0", "0,2,join,90,0", "0,3,join,0,90"])
        self.start_gateway(buses, head='[site]\nfile = "site.poly"\n')
        self.wait_for_header(nodes=3, features=2, state=0)


class WithoutWhatItNeeds(GatewayCase):
    """What cannot be had at the start costs nothing else, and is had as soon as it can be."""

    def setUp(self):
        super().setUp()
        self.taken = socket.socket()
        self.addCleanup(self.taken.close)
        self.taken.bind(("127.0.0.1", 0))
        self.taken.listen()
        self.address = "127.0.0.1:%d" % self.taken.getsockname()[1]

    def health(self, url):
        try:
            with urllib.request.urlopen(url + "/healthz", timeout=PATIENCE_S) as answer:
                return answer.read().decode()
        except urllib.error.HTTPError as error:
            return error.read().decode()

    def test_a_page_comes_when_its_port_is_free_and_all_else_is_there_before(self):
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0", "0,2,join,9,0"]),
                                     f'[http]\nlisten = "{self.address}"\n')
        gateway.wait_for_line(rf"error: there is no status page: cannot listen on {self.address} "
                              r"\(Address already in use\); end the program that has it .*`listen` of "
                              r"\[http\]; goes on, and tries again")
        self.wait_for_header(nodes=2, state=0)
        self.taken.close()
        gateway.wait_for_line(f"shows the status page on http://{self.address}")
        self.assertEqual(self.health(f"http://{self.address}"), "ok\n")
        self.assertEqual(gateway.stop(), 0, gateway.log())
        self.assertEqual(gateway.log().count("there is no status page"), 1)

    def test_files_come_when_their_folder_can_be_made_and_all_else_is_there_before(self):
        (self.folder / "out").write_text("in the way")
        gateway = self.start_gateway([("127.0.0.1:9", "1")])
        gateway.wait_for_line(r"error: out: cannot make the folder \(Not a directory\); look at "
                              r"`folder` of \[files\]; goes on, and tries again")
        gateway.stop(signal.SIGKILL)
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0", "0,2,join,9,0"]))
        self.wait_for_header(nodes=2, state=0)
        (self.folder / "out").unlink()
        gateway.wait_for_line("files are written again")
        nodes = self.folder / "out" / "mesh.node"
        wait_for("both nodes in the files",
                 lambda: nodes.exists() and re.search(r"^2 2 ", nodes.read_text(), re.M))
        self.assertEqual(gateway.log().count("goes on, and tries again"), 1)

    def test_the_mesh_is_served_when_its_port_is_free_and_the_page_says_so_before(self):
        gateway = self.start_gateway([("127.0.0.1:9", "1")], '[http]\nlisten = "127.0.0.1:0"\n',
                                     listen=self.address, wait=False)
        gateway.wait_for_line(rf"error: the mesh is not served: cannot listen on {self.address}")
        url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        self.assertIn("nobody can read the mesh", self.health(url))
        self.taken.close()
        gateway.wait_for_line(f"serves the mesh on {self.address}")
        self.port = int(self.address.split(":")[1])
        self.wait_for_header(nodes=0)
        self.assertNotIn("nobody can read the mesh", self.health(url))


class ListsOfTheMap(GatewayCase):
    """Read by pymodbus, as the tables that the gateway prints say."""

    SITE = {"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"kind": "domain"}, "geometry": {
            "type": "Polygon", "coordinates": [[[0, 0], [1000, 0], [1000, 1000], [0, 1000], [0, 0]]]}},
        {"type": "Feature", "properties": {"kind": "hole"}, "geometry": {
            "type": "Polygon", "coordinates": [[[400, 400], [600, 400], [600, 600], [400, 600],
                                                [400, 400]]]}},
        {"type": "Feature", "properties": {"serials": [1, None, 2]}, "geometry": {
            "type": "LineString", "coordinates": [[100, 100], [800, 200], [900, 900]]}}]}

    def tables(self):
        """{heading: ({name: (offset, registers)}, entries of a block, registers of an entry)}"""
        text = subprocess.run([PROGRAMS / "etcm-gateway", "--register-map"], capture_output=True,
                              text=True, timeout=PATIENCE_S, check=True).stdout
        found = {}
        for part in re.split(r"\n(?=[A-Z])", text):
            heading = part.split(":")[0]
            size = re.search(r"then (\d+) \w+ of (\d+) registers", part)
            rows = re.findall(r"^\| (\d+)(?:-(\d+))? \| (\w+) \|", part, re.M)
            found[heading] = ({name: (int(first), int(last or first) - int(first) + 1)
                               for first, last, name in rows},
                              *(int(number) for number in (size.groups() if size else (0, 0))))
        return found

    def block(self, number):
        answer = self.client.read_input_registers(number % 546 * 120, 120, slave=1 + number // 546)
        self.assertFalse(answer.isError(), answer)
        return answer.registers

    @staticmethod
    def value(registers, at, count):
        return registers[at] if count == 1 else registers[at] << 16 | registers[at + 1]

    def read_map(self):
        """The header and the lists of one generation, on one connection."""
        tables = self.tables()
        block = self.block(0)
        header = {name: self.value(block, *place) for name, place in tables["Header"][0].items()}
        lists = {}
        for name, heading in [("vertex", "Vertex block"), ("relay", "Relay block"),
                              ("hole", "Hole block"), ("gap", "Gap block"),
                              ("long_link", "Long link block"), ("quarantine", "Quarantine block")]:
            rows, per_block, size = tables[heading]
            used = header["vertex_rows" if name == "vertex" else name + "_entries"]
            lists[name] = []
            for number in range(header[name + "_block_first"],
                                header[name + "_block_first"] + header[name + "_blocks"]):
                if len(lists[name]) == used:
                    break
                block = self.block(number)
                self.assertEqual(self.value(block, 0, 2), header["generation"])
                for entry in range(min(per_block, used - len(lists[name]))):
                    at = 2 + entry * size
                    lists[name].append({row: self.value(block, at + first, count)
                                        for row, (first, count) in rows.items()})
            self.assertEqual(len(lists[name]), used)
        return header, lists

    def test_they_are_the_lists_of_the_map_document(self):
        from pymodbus.client import ModbusTcpClient
        (self.folder / "site.geojson").write_text(json.dumps(self.SITE))
        buses = self.start_nodes(["0,1,join,100,100", "0,2,join,900,900", "0,3,join,350,500",
                                  "0,4,join,650,500", "0,5,join,0,0", "0,6,join,500,500",
                                  "0,7,join,-5,500", "1500,8,join,350,500", "0,9,join,820,260"])
        gateway = self.start_gateway(
            buses, head='[site]\nfile = "site.geojson"\ncrs = "plane"\n',
            more='[http]\nlisten = "127.0.0.1:0"\n'
                 '[analysis]\nradio_range = 300\nsensing_range = 200\n')
        url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        self.wait_for_header(nodes=6, quarantined=3)
        self.client = ModbusTcpClient("127.0.0.1", port=self.port)
        self.assertTrue(self.client.connect())

        def of_one_generation():
            with urllib.request.urlopen(url + "/mesh.geojson", timeout=PATIENCE_S) as answer:
                document = json.load(answer)
            header, lists = self.read_map()
            return (document, header, lists) if document["generation"] == header["generation"] else None
        document, header, lists = wait_for("one generation in both", of_one_generation)
        self.client.close()

        def point(entry):
            signed = lambda value: value - (value >> 31 << 32)
            return tuple(round(signed(entry[axis]) + entry[axis + "_fraction"] / 2 ** 28, 3)
                         for axis in "xy")

        def rounded(place):
            return tuple(round(coordinate, 3) for coordinate in place)
        places = [point(vertex) for vertex in lists["vertex"]]
        kinds = [vertex["kind"] & 0xFF for vertex in lists["vertex"]]
        features = document["features"]

        def points_of(kind):
            return [feature for feature in features if feature["properties"]["kind"] == kind
                    and feature["geometry"]["type"] == "Point"]

        def lines_of(kind):
            return sorted(sorted(map(rounded, line)) for feature in features
                          if feature["properties"]["kind"] == kind
                          for line in feature["geometry"]["coordinates"])

        def lines(entries):
            return sorted(sorted((places[entry["from_row"]], places[entry["to_row"]]))
                          for entry in entries)

        for name in ["relay", "hole", "gap", "long_link"]:
            self.assertGreater(len(lists[name]), 0, name)
            self.assertEqual(header[name + "_count"], len(lists[name]), name)
        # The document has Steiner vertices as such.
        at_steiner = [entry for entry in lists["relay"]
                      if entry["row"] != 0xFFFFFFFF and kinds[entry["row"]] == 2]
        self.assertEqual(len(at_steiner), header["steiner_count"])
        for entry in lists["relay"]:
            if entry["row"] != 0xFFFFFFFF:
                self.assertEqual(point(entry), places[entry["row"]])
        def same_places(entries, features, name):
            # The document has decimals, so a place may stand one of the last digit aside.
            entries = sorted((entry[name], point(entry)) for entry in entries)
            features = sorted((feature["properties"][name],
                               rounded(feature["geometry"]["coordinates"])) for feature in features)
            self.assertEqual([value for value, _ in entries], [value for value, _ in features])
            for (_, one), (_, other) in zip(entries, features):
                self.assertLessEqual(max(abs(a - b) for a, b in zip(one, other)), 0.0011)

        same_places([entry for entry in lists["relay"] if entry not in at_steiner],
                    points_of("relay"), "feature")
        same_places(lists["hole"], points_of("hole"), "distance")
        for x, y in map(point, lists["hole"]):
            self.assertFalse(400 < x < 600 and 400 < y < 600, "in the hole of the site")
        unwatched = [entry for entry in lists["gap"] if not entry["gap_flags"] & 1]
        self.assertEqual(len(unwatched), header["unwatched_gap_count"])
        self.assertEqual(lines(unwatched), lines_of("gaps"))
        self.assertEqual(lines(lists["long_link"]), lines_of("long_links"))
        for entry in lists["long_link"]:
            self.assertEqual([kinds[entry["from_row"]], kinds[entry["to_row"]]], [1, 1])
        self.assertEqual(header["quarantined_count"], 3)
        self.assertEqual(
            sorted((entry["kind"], entry["reason"], entry["serial"], entry["bus"],
                    entry["x"] - (entry["x"] >> 31 << 32), entry["y"])
                   for entry in lists["quarantine"]),
            [(1, 1, 7, 1, -5, 500), (1, 2, 6, 1, 500, 500), (1, 10, 8, 1, 350, 500)])


if __name__ == "__main__":
    unittest.main(verbosity=2)
