"""etcm-bus as a person runs it: on simulated nodes over TCP and on a serial line, on pymodbus, and
on what is no bus at all. The programs are in ETCM_BUS and ETCM_NODES."""
import json
import os
import pathlib
import pty
import re
import signal
import socket
import subprocess
import sys
import threading
import unittest

from programs import PATIENCE_S, ProgramCase, free_port, wait_for

BUS, NODES = os.environ["ETCM_BUS"], os.environ["ETCM_NODES"]
# A busy machine lets units wait for their turn longer than a bus would.
PATIENT = ["-o", "0.5"]
PEER = pathlib.Path(__file__).resolve().parents[2] / "system" / "pymodbus_nodes.py"


class BusCase(ProgramCase):
    def start_nodes(self, rows, *link):
        (self.folder / "nodes.csv").write_text("time_ms,serial,event,x,y\n" + "\n".join(rows) + "\n")
        nodes = self.start("nodes", [NODES, *link, "--nodes", "nodes.csv"])
        nodes.wait_for_line(r"ready:")
        return nodes

    def start_line(self, rows):
        """Nodes on a serial line, fast enough that tests do not wait for bytes."""
        line = str(self.folder / "line")
        self.start_nodes(rows, "--rtu", line, "--baud", "115200")
        return ["-b", "115200", line]

    def start_tcp(self, rows):
        nodes = self.start_nodes(rows, "--listen", "127.0.0.1:0")
        return [re.search(r"listens on (\S+)", nodes.log()).group(1)]

    def bus(self, *arguments, code=0):
        done = subprocess.run([BUS, *arguments], capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def complaint(self, *arguments, code=1):
        """What it says, which is one line and all it says."""
        done = self.bus(*arguments, code=code)
        self.assertRegex(done.stderr, r"\Aetcm-bus: [^\n]+\n\Z")
        self.assertEqual(done.stdout, "")
        return done.stderr


THREE = ["0,70001,join,100,-5", "0,70002,join,-900,0", "0,70003,join,400,700"]


class Scan(BusCase):
    def test_finds_who_is_there_on_either_kind_of_bus(self):
        for start in (self.start_line, self.start_tcp):
            device = start(THREE + ["0,4,join,0,0", "0,4,exception,2,"])
            done = self.bus("scan", *PATIENT, "-a", "1:6", *device)
            rows = [line.split() for line in done.stdout.splitlines()[1:]]
            self.assertEqual([row[0] for row in rows], ["1", "2", "3", "4"])
            self.assertEqual(rows[0][1:4], ["70001", "100,", "-5"])
            self.assertIn("ETCM simulated node 1", done.stdout)
            self.assertIn("exception 2: Illegal data address", done.stdout)
            self.assertIn("4 answer, 3 of them position nodes", done.stderr)
            self.assertIn("by a profile: etcm-bus probe --profile NAME -a UNIT", done.stderr)

    def test_hosts_have_names_at_both_ends(self):
        nodes = self.start_nodes(THREE, "--listen", "localhost:0")
        port = re.search(r"listens on \S+:(\d+)", nodes.log()).group(1)
        self.assertIn("70001", self.bus("scan", *PATIENT, "-a", "1", f"localhost:{port}").stdout)
        for place, what in (("no-such-host.invalid:1502", "give a name of this machine"),
                            ("nonsense", "no address; write it as 127.0.0.1:1502")):
            done = subprocess.run([NODES, "--listen", place, "--nodes", self.folder / "nodes.csv"],
                                  capture_output=True, text=True, timeout=PATIENCE_S)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(what, done.stderr)

    def test_the_nodes_say_who_complains_and_what_to_do(self):
        nodes = self.start_nodes(THREE, "--listen", "127.0.0.1:0")
        taken = re.search(r"listens on (\S+)", nodes.log()).group(1)
        (self.folder / "wrong.csv").write_text("time_ms,serial,event,x,y\n0,1,dance,0,0\n")
        (self.folder / "many.csv").write_text(
            "time_ms,serial,event,x,y\n" + "".join(f"0,{n},join,{n},0\n" for n in range(1, 249)))
        for code, line, what in (
                (1, ["--listen", taken, "--nodes", "nodes.csv"],
                 rf"cannot listen on {taken} \(Address already in use\); end the program that has it "
                 r"\(`ss -ltnp` names it\), or change --listen"),
                (2, ["--listen", "nonsense", "--nodes", "nodes.csv"], "--listen nonsense: no address; .+"),
                (2, ["--rtu", "line", "--baud", "1", "--nodes", "nodes.csv"], "--baud 1: no speed; give .+"),
                (2, ["--listen", taken, "--nodes", "none.csv"], "none.csv: cannot be read; .+"),
                (2, ["--listen", taken, "--nodes", "wrong.csv"], "wrong.csv:2: .+"),
                (2, ["--rtu", "line", "--nodes", "many.csv"], "many.csv: 248 nodes, but .+; take some out.+")):
            with self.subTest(line):
                done = subprocess.run([NODES, *line], cwd=self.folder, capture_output=True, text=True,
                                      timeout=PATIENCE_S)
                self.assertEqual((done.returncode, done.stdout), (code, ""))
                self.assertRegex(done.stderr, rf"\Aetcm-nodes: {what}\n\Z")

    def test_tells_a_program_in_json(self):
        found = json.loads(self.bus("scan", *PATIENT, "-a", "1:5", "--json", *self.start_line(THREE)).stdout)
        self.assertEqual([unit["unit"] for unit in found], [1, 2, 3])
        self.assertEqual(found[1]["node"], {"serial": 70002, "x": -900, "y": 0, "status": 1,
                                            "boots": 1})
        self.assertEqual(found[1]["product"], "simulated node")

    def test_units_that_misbehave_are_named_and_hide_nobody(self):
        device = self.start_line(["0,1,join,0,0", "0,1,garbled,,", "0,2,join,5,5", "0,2,noise,,",
                                  "0,3,join,1,1", "0,3,truncated,,", "0,4,join,2,2", "0,4,torn,,",
                                  "0,5,join,3,3"])
        found = {unit["unit"]: unit for unit in json.loads(
            self.bus("scan", *PATIENT, "-a", "1:6", "--json", *device).stdout)}
        self.assertEqual(sorted(found), [1, 2, 3, 4, 5])
        self.assertIn("garbled", found[1]["trouble"])
        self.assertEqual(found[2]["node"]["serial"], 2)
        self.assertIn("garbled", found[3]["trouble"])
        self.assertIn("torn", found[4]["trouble"])
        self.assertEqual(found[5]["trouble"], "")

    def test_nobody_there_says_where_to_look(self):
        serial = self.bus("scan", "-a", "50:52", *self.start_line(THREE), code=1).stderr
        self.assertIn("nobody answers: try A and B exchanged, another speed", serial)
        tcp = self.bus("scan", "-a", "50:52", *self.start_tcp(THREE), code=1).stderr
        self.assertIn("serial side of the converter", tcp)

    def test_a_wrong_byte_order_is_named(self):
        answer = self.bus("scan", *PATIENT, "-a", "1", "-w", "BADC", *self.start_tcp(THREE)).stdout
        self.assertIn("bytes swapped", answer)

    def test_an_interrupt_leaves_what_was_found(self):
        device = self.start_tcp(THREE)
        scan = self.start("scan", [BUS, "scan", "-o", "5", *device])
        scan.wait_for_line(r"70003")
        self.assertEqual(scan.stop(signal.SIGINT), 130)
        self.assertIn("3 answer", scan.log())

    def test_shows_progress_to_a_person(self):
        device = self.start_line(THREE)
        near, far = pty.openpty()
        self.addCleanup(os.close, near)
        done = subprocess.Popen([BUS, "scan", *PATIENT, "-a", "1:5", *device], stderr=far,
                                stdout=subprocess.DEVNULL)
        os.close(far)
        shown = b""
        try:
            while piece := os.read(near, 4096):
                shown += piece
        except OSError:  # the other end is closed
            pass
        self.assertEqual(done.wait(PATIENCE_S), 0)
        self.assertIn(b"unit 4, 3 of 5 asked, 3 found", shown)


class Poll(BusCase):
    def test_shows_the_nodes_round_after_round(self):
        device = self.start_line(THREE + ["0,4,join,0,0", "0,4,silent,,"])
        done = self.bus("poll", *PATIENT, "-a", "1:4", "-l", "10", "-n", "3", *device)
        last = done.stdout.strip().splitlines()[-4:]
        self.assertRegex(last[0], r"^ +1 +70001 +100 +-5 +\d+\.\d s +\d+\.\d ms +\d+\.\d ms +3 +0  fix$")
        self.assertRegex(last[3], r"^ +4 .* 3 +3  no answer$")

    def test_a_late_answer_is_not_shown_as_the_next_ones(self):
        device = self.start_line(["0,7,join,100,0", "0,7,late,2100,"])
        done = self.bus("poll", "-a", "1", "-l", "250", "-n", "12", *device, code=1)
        self.assertRegex(done.stdout.strip().splitlines()[-1], r"^ +1 +- +- .* 12 +12  ")

    def test_nobody_is_no_success(self):
        self.assertIn("no position node answered",
                      self.bus("poll", "-n", "1", "-a", "9", *self.start_tcp(THREE), code=1).stderr)

    def test_ends_well_when_interrupted(self):
        poll = self.start("poll", [BUS, "poll", *PATIENT, "-l", "50", *self.start_tcp(THREE)])
        poll.wait_for_line(r"70001")
        self.assertEqual(poll.stop(signal.SIGINT), 0)


class Read(BusCase):
    def values(self, *arguments):
        text = self.bus("read", *arguments).stdout
        return [line.split()[1] for line in text.splitlines() if not line.startswith("unit")]

    def test_reads_what_mbpoll_reads(self):
        device = self.start_line(THREE)
        options = ["-t", "3:hex", "-0", "-r", "0", "-c", "12", "-1", "-q", "-B", "-a", "2"]
        ours = self.values(*options, *device)
        done = subprocess.run(["mbpoll", "-m", "rtu", "-b", "115200", "-P", "even", *options,
                               device[-1]],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(ours, re.findall(r"^\[\d+\]:\s+(\S+)", done.stdout, re.M), done.stdout)

    def test_reads_what_pymodbus_serves(self):
        port = free_port()
        self.start("peer", [sys.executable, PEER, port, "70001,-3,4", "70002,100,0"])
        device = f"127.0.0.1:{port}"
        wait_for("the peer", lambda: subprocess.run([BUS, "read", device],
                                                    capture_output=True).returncode == 0)
        self.assertEqual(self.values("-t", "3:i32", "-r", "5", "-c", "2", "-a", "1,2", device),
                         ["-3", "4", "100", "0"])
        self.assertEqual(self.values("-t", "3:u32", "-r", "2", "-a", "1", "-w", "CDAB", device),
                         [str((70001 & 0xFFFF) << 16 | 70001 >> 16)])

    def test_frames_are_shown_as_mbpoll_shows_them(self):
        for start in (self.start_line, self.start_tcp):
            device = start(THREE)
            done = self.bus("read", "-v", "-a", "2", "-t", "3", "-r", "2", "-c", "2", *device)
            self.assertRegex(done.stderr, r"\A(\[00\]\[01\](\[00\]){3}\[06\])?"
                                          r"\[02\]\[04\]\[00\]\[02\]\[00\]\[02\]\S*\n"
                                          r"\S*<02><04><04><00><01><11><72>\S*\n\Z")
            self.assertEqual(self.bus("read", "-a", "2", *device).stderr, "")

    def test_coils_and_inputs_are_those_of_mbpoll(self):
        port = free_port()
        self.start("peer", [sys.executable, PEER, port, "70001,-3,4"])
        device = f"127.0.0.1:{port}"
        wait_for("the peer", lambda: subprocess.run([BUS, "read", device],
                                                    capture_output=True).returncode == 0)
        bits = ["1", "0", "0", "1", "1", "1", "0", "0", "0", "1"]
        said = self.bus("write", "-t", "0", "-r", "7", device, *bits).stdout
        self.assertTrue(said.startswith("unit 1\n    7  was 0, is 1\n"), said)
        self.bus("write", "-t", "0", "-r", "17", device, "1")
        self.assertEqual(self.values("-t", "0", "-r", "6", "-c", "13", device), ["0", *bits, "1", "0"])
        done = subprocess.run(["mbpoll", "-m", "tcp", "-p", str(port), "-t", "0", "-0", "-r", "6", "-c",
                               "13", "-1", "127.0.0.1"],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(re.findall(r"^\[\d+\]:\s+(\S+)", done.stdout, re.M), ["0", *bits, "1", "0"])
        self.assertEqual(set(self.values("-t", "1", "-c", "3000", device)), {"0"})
        self.assertIn("a coil is 0 or 1", self.complaint("write", "-t", "0", device, "2", code=2))
        self.assertIn("cannot be written", self.complaint("write", "-t", "1", device, "1", code=2))

    def test_types_change_what_stands_there(self):
        device = self.start_tcp(["0,1,join,-2,16256"])
        self.assertEqual(self.values("-r", "5", "-c", "2", *device), ["65535", "65534"])
        self.assertEqual(self.values("-t", "4:i16", "-r", "5", "-c", "2", *device), ["-1", "-2"])
        self.assertEqual(self.values("-t", "4:int", "-r", "0x5", *device), ["-2"])
        self.assertEqual(self.values("-t", "4:float", "-r", "8", "-w", "ABCD", *device)[0][:4],
                         "1.00")

    def test_troubles_are_one_line_each_with_the_unit(self):
        device = self.start_line(THREE)
        self.assertRegex(self.complaint("read", "-a", "9", *device),
                         r"unit 9 on .*: no answer; check the unit \(-a\), .* -b and -P")
        self.assertRegex(self.complaint("read", "-c", "100", *device),
                         r"exception 2: Illegal data address; .* count from 0")


class Write(BusCase):
    """On pymodbus, whose registers can be written and which has FC 6 and 16 of its own."""

    def setUp(self):
        super().setUp()
        port = free_port()
        self.start("peer", [sys.executable, PEER, port, "70001,-3,4", "70002,100,0"])
        self.device = f"127.0.0.1:{port}"
        wait_for("the peer", lambda: subprocess.run([BUS, "read", self.device],
                                                    capture_output=True).returncode == 0)

    def test_tells_what_was_there_and_what_is(self):
        done = self.bus("write", "-a", "1", "-t", "4:i32", "-r", "5", self.device, "-70000", "8")
        self.assertEqual(done.stdout, "unit 1\n    5  was -3, is -70000\n    7  was 4, is 8\n")
        self.assertEqual(self.bus("read", "-a", "2", "-t", "4:i32", "-r", "5", self.device).stdout,
                         "    5  100\n", "the other unit")

    def test_values_below_zero_are_values(self):
        for kind, values in (("i16", ["-15"]), ("i16", ["3", "-12"]), ("i16", ["7", "-1"]),
                             ("i16", ["-1", "7"]), ("i16", ["100", "-10", "0"]), ("i16", ["-100"]),
                             ("i32", ["3", "-123"]), ("float", ["-0.5", "-1.5"])):
            with self.subTest(kind, values=values):
                self.bus("write", "-a", "2", "-t", "4:" + kind, "-r", "5", self.device, *values)
                read = self.bus("read", "-a", "2", "-t", "4:" + kind, "-r", "5", "-c",
                                str(len(values)), self.device).stdout
                self.assertEqual(read.split()[1::2], values)

    def test_no_option_follows_two_hyphens(self):
        self.bus("write", "-a", "2", "-t", "4:i16", "-r", "5", "--", self.device, "-1", "-20")
        self.assertEqual(self.bus("read", "-a", "2", "-t", "4:i16", "-r", "5", "-c", "2",
                                  self.device).stdout.split(), ["5", "-1", "6", "-20"])

    def test_what_mbpoll_reads_is_what_was_written(self):
        self.bus("write", "-a", "2", "-r", "0", "-t", "4:hex", self.device, "0x1234", "0xBEEF")
        done = subprocess.run(["mbpoll", "-m", "tcp", "-p", self.device.split(":")[1], "-a", "2",
                               "-t", "4:hex", "-0", "-r", "0", "-c", "2", "-1", "127.0.0.1"],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(re.findall(r"^\[\d+\]:\s+(\S+)", done.stdout, re.M), ["0x1234", "0xBEEF"])

    def test_a_broadcast_is_asked_for(self):
        said = self.complaint("write", "-a", "0", self.device, "1", code=2)
        self.assertIn("--broadcast", said)
        self.complaint("write", "-a", "1", "--broadcast", self.device, "1", code=2)
        self.complaint("write", "-a", "0,1", "--broadcast", self.device, "1", code=2)

    def test_nothing_is_written_where_nothing_can_be_read(self):
        self.assertIn("nothing was written",
                      self.complaint("write", "-a", "1", "-r", "500", self.device, "1"))
        self.assertIn("does not take it",
                      self.complaint("write", "--blind", "-a", "1", "-r", "500", self.device, "1"))

    def test_values_that_do_not_fit_send_nothing(self):
        for arguments in (["65536"], ["-t", "4:i16", "40000"], ["x"], ["-t", "3", "1"],
                          ["-r", "65535", "1", "2"], ["1"] * 124):
            options = arguments[:2] if arguments[0].startswith("-") else []
            values = arguments[len(options):]
            self.complaint("write", *options, self.device, *values, code=2)


class RawUnit:
    """Registers over TCP, whatever the unit. `act` is asked before each answer: "mute" leaves it out,
    "close" ends the connection."""

    def __init__(self, case, act, registers):
        self.registers, self.act = dict(enumerate(registers)), act
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.name = "127.0.0.1:%d" % self.listener.getsockname()[1]
        case.addCleanup(self.listener.close)
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        try:
            while True:
                client = self.listener.accept()[0]
                with client:
                    while self.answer(client):
                        pass
        except OSError:
            pass

    def answer(self, client):
        head = client.recv(7, socket.MSG_WAITALL)
        if len(head) < 7:
            return False
        pdu = client.recv(int.from_bytes(head[4:6], "big") - 1, socket.MSG_WAITALL)
        first, count = int.from_bytes(pdu[1:3], "big"), int.from_bytes(pdu[3:5], "big")
        answer = pdu[:1] + b"\x01"
        if pdu[0] == 16:
            for i in range(count):
                self.registers[first + i] = int.from_bytes(pdu[6 + 2 * i:8 + 2 * i], "big")
            answer = pdu[:5]
        elif pdu[0] in (3, 4):
            values = [self.registers.get(first + i, 0) for i in range(count)]
            answer = pdu[:1] + bytes([2 * count]) + b"".join(v.to_bytes(2, "big") for v in values)
        else:
            answer = bytes([pdu[0] | 0x80, 1])
        what = self.act(head[6], pdu[0])
        if what == "close":
            return False
        if what != "mute":
            client.sendall(head[:4] + (len(answer) + 1).to_bytes(2, "big") + head[6:] + answer)
        return True


class LostAnswers(BusCase):
    def test_what_stood_there_is_told_where_a_write_is_not_answered(self):
        unit = RawUnit(self, lambda unit, function: "mute" if function == 16 else "", [7, 8])
        done = self.bus("write", "-o", "0.2", unit.name, "100", "200", "-r", "0", code=1)
        self.assertEqual(done.stdout, "unit 1\n    0  was 7, is 100\n    1  was 8, is 200\n")
        self.assertIn("does not say whether it took it: no answer", done.stderr)
        self.assertIn("does not say whether it took it",
                      self.complaint("write", "--blind", "-o", "0.2", unit.name, "1"))

    def test_what_stood_there_is_told_where_the_connection_goes(self):
        unit = RawUnit(self, lambda unit, function: "close" if function == 16 else "", [7, 8])
        done = self.bus("write", unit.name, "100", code=1)
        self.assertEqual(done.stdout, "unit 1\n    0  was 7, is not known\n")
        self.assertIn("it may have taken it", done.stderr)

    def test_what_stood_there_is_told_where_it_is_interrupted(self):
        asked = threading.Event()
        def act(unit, function):
            if function != 16:
                return ""
            asked.set()
            return "mute"
        unit = RawUnit(self, act, [7])
        write = self.start("write", [BUS, "write", "-o", "10", unit.name, "100"])
        self.assertTrue(asked.wait(PATIENCE_S))
        self.assertEqual(write.stop(signal.SIGINT), 130)
        self.assertIn("    0  was 7, is not known", write.log())
        self.assertIn("interrupted, and it may have taken it", write.log())

    def node(self, act):
        return RawUnit(self, act, [0x4554, 0x010c, 0, 1001, 1, 0, 5, 0, 0, 1, 3, 1])

    def test_a_poll_goes_on_over_a_connection_that_was_lost(self):
        counts = []
        def act(unit, function):
            counts.append(unit)
            return "close" if len(counts) == 3 else ""
        done = self.bus("poll", "-l", "20", "-n", "8", self.node(act).name)
        rows = [line for line in done.stdout.splitlines() if line.startswith("   1")]
        self.assertEqual(len(rows), 8, done.stdout)
        self.assertIn("no connection", rows[2])
        self.assertIn("fix", rows[7])
        self.assertIn("trying again", done.stderr)

    def test_a_scan_tells_what_it_found_before_the_connection_was_lost(self):
        unit = self.node(lambda unit, function: "close" if unit == 3 else "")
        done = self.bus("scan", "-a", "1-5", "--json", unit.name, code=1)
        self.assertEqual([found["unit"] for found in json.loads(done.stdout)], [1, 2])
        self.assertIn("try again", done.stderr)


class Refusals(BusCase):
    def test_bad_command_lines_send_nothing(self):
        for arguments, what in ((["read", "-t", "5"], "-t 5"), (["read", "-r", "65536"], "-r 65536"),
                                (["read", "-a", "0"], "-a 0"), (["scan", "-a", "1:300"], "-a 1:300"),
                                (["read", "-r", "65530", "-c", "10"], "65535"),
                                (["read", "-t", "4:u64"], "-t 4:u64"), (["scan", "-o", "x"], "-o x"),
                                (["scan", "-o", "0"], "-o 0"), (["scan", "-o", "nan"], "-o nan"),
                                (["scan", "-b", "49"], "-b 49"), (["poll", "-w", "AB"], "-w AB"),
                                (["read", "-c", "0"], "--count")):
            self.assertIn(what, self.complaint(*arguments, "/dev/null/x", code=2))
        self.assertIn("device", self.complaint("scan", code=2))
        self.assertIn("a command is required", self.complaint(code=2))
        self.assertIn("red", self.complaint("red", "/dev/null/x", code=2))

    def test_ports_that_cannot_be_had_come_with_the_cure(self):
        self.assertIn("ls /dev/serial/by-path", self.complaint("scan", "/dev/no such port"))
        for path, what in (("/dev/null", "is a device, and no serial port; ls /dev/serial"),
                           ("/etc/passwd", "is a file, and no serial port; ls /dev/serial"),
                           ("/etc", "is a folder, and no serial port; ls /dev/serial")):
            self.assertIn(what, self.complaint("scan", "-m", "rtu", path))
        device = self.start_line(THREE)
        busy = self.start("busy", [BUS, "poll", *PATIENT, *device])
        busy.wait_for_line("70001")
        self.assertIn("another program has it", self.complaint("scan", *device))
        self.assertEqual(busy.stop(signal.SIGTERM), 0)

    def test_hosts_that_cannot_be_reached_come_with_the_cure(self):
        refused = self.complaint("scan", f"127.0.0.1:{free_port()}")
        self.assertIn("Connection refused; nothing listens there: check address and port", refused)
        self.assertIn("no host", self.complaint("scan", "127.0.0.1:x", code=2))
        self.assertIn("getent hosts", self.complaint("scan", "no-such-host.invalid"))
        for short in "127.1:502", "10.0.5", "10.0.0.256", "1":
            self.assertIn("four numbers", self.complaint("scan", short, code=2))

    def hostile(self, answer):
        """A peer that answers whatever comes with these bytes."""
        server = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(server.close)

        def serve():
            try:
                client, _ = server.accept()
                with client:
                    while request := client.recv(300):
                        client.sendall(answer(request))
            except OSError:
                pass

        threading.Thread(target=serve, daemon=True).start()
        return f"127.0.0.1:{server.getsockname()[1]}"

    def test_what_is_no_modbus_is_said_and_harms_nobody(self):
        self.assertIn("no Modbus TCP",
                      self.complaint("read", self.hostile(lambda _: b"HTTP/1.1 400 Bad\r\n")))
        wrong_number = self.hostile(lambda request: b"\xff\xff" + request[2:])
        self.assertIn("no answer", self.complaint("read", "-o", "0.1", wrong_number))
        wrong_unit = self.hostile(lambda request: request[:2] + bytes([0, 0, 0, 3, 99, 0x84, 1]))
        self.assertIn("garbled", self.complaint("read", wrong_unit))

    def test_texts_of_a_device_cannot_steer_the_terminal(self):
        def answer(request):
            pdu = {4: b"\x84\x02", 43: b"\x2b\x0e\x01\x81\0\0\x01\0\x04\x1b[2J"}[request[7]]
            return request[:2] + bytes([0, 0, 0, 1 + len(pdu), request[6]]) + pdu

        done = self.bus("scan", *PATIENT, "-a", "1", self.hostile(answer))
        self.assertIn("?[2J", done.stdout)
        self.assertNotIn("\x1b", done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
