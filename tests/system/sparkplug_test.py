"""The gateway as an edge node of Sparkplug, for real: Mosquitto between it and a host that decodes
by Eclipse Tahu's library for Node.js and keeps to the specification. The programs' folder is in
ETCM_BIN, that for what comes from npm in ETCM_NPM."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from broker import SITE, Broker, add_users
from gateway_test import GatewayCase
from programs import PATIENCE_S, wait_for

SKIPPED = 77
CONSUMER = pathlib.Path(os.environ["ETCM_NPM"]).resolve() / "sparkplug"

NODES = ["0,7,join,300,-200", "0,8,join,-40,90", "0,9,join,5,6"]
METER = """
[[profile]]
name = "meter"
function = 4
serial = { register = 2, type = "u32" }
x = { register = 5, type = "i32" }
y = { register = 7, type = "i32" }
[[profile.reading]]
name = "magic"
unit = "°C"
value = { register = 0, type = "u16", scale = "0.001" }
"""


def install_consumer():
    """Why there is none; None: it is there, as the lock file has it."""
    lock = (HERE / "sparkplug" / "package-lock.json").read_text()
    stamp = CONSUMER / "installed"
    if stamp.is_file() and stamp.read_text() == lock:
        shutil.copy(HERE / "sparkplug" / "consumer.js", CONSUMER)
        return None
    for program in ("node", "npm"):
        if shutil.which(program) is None:
            return f"{program} is not installed; apt-get install npm"
    CONSUMER.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "package-lock.json", "consumer.js"):
        shutil.copy(HERE / "sparkplug" / name, CONSUMER)
    done = subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"],
                          cwd=CONSUMER, capture_output=True, text=True, timeout=5 * PATIENCE_S)
    if done.returncode == 0:
        stamp.write_text(lock)
        return None
    unreachable = ("ENOTFOUND", "EAI_AGAIN", "ECONNREFUSED", "ECONNRESET", "ETIMEDOUT",
                   "ENETUNREACH")
    if any(code in done.stderr for code in unreachable):
        return "npm cannot reach its registry"
    raise AssertionError(f"npm ci failed:\n{done.stdout}{done.stderr}")


class Host:
    """What a host application knows after each message; complains of what is not allowed."""

    def __init__(self):
        self.births = []   # the bdSeq of each NBIRTH, in order
        self.deaths = []   # the same of each NDEATH
        self.names = {}    # by alias: device (or None) and name
        self.values = {}   # by device (or None): by name
        self.properties = {}
        self.alive = set()  # devices
        self.is_online = False
        self.has_birth = False  # since it has listened without a break
        self.next_seq = None
        self.mistakes = []

    def value(self, device, name):
        return self.values.get(device, {}).get(name)

    def need(self, holds, what, message):
        if not holds:
            self.mistakes.append(f"{what}: {json.dumps(message)[:400]}")

    def take(self, message):
        space, group, kind, edge, *device = message["topic"].split("/")
        self.need((space, group, edge) == ("spBv1.0", SITE, "north"), "topic", message)
        self.need(not message["retained"], "retained", message)
        self.need(message["qos"] <= (kind == "NDEATH"), "quality of service", message)
        self.need(abs(message["time"] - time.time() * 1000) < 60_000, "time", message)
        self.need(len(device) == kind.startswith("D"), "levels of the topic", message)
        device = device[0] if device else None
        if kind == "NDEATH":
            return self.take_death(message)
        if kind != "NBIRTH" and not self.has_birth:
            return
        self.need(message["seq"] == (0 if kind == "NBIRTH" else self.next_seq), "sequence", message)
        self.next_seq = (message["seq"] + 1) % 256
        times = [metric["time"] for metric in message["metrics"]]
        self.need(times == sorted(times) and None not in times, "times", message)
        if kind == "DDEATH":
            self.need(device in self.alive, "death of the dead", message)
            self.alive.discard(device)
        elif kind in ("NBIRTH", "DBIRTH"):
            self.take_birth(message, device)
        else:
            self.take_data(message, device)

    def take_death(self, message):
        [metric] = message["metrics"]
        self.need(metric["name"] == "bdSeq" and message["seq"] is None, "NDEATH", message)
        self.deaths.append(metric["value"])
        if self.births and metric["value"] == self.births[-1]:
            self.is_online = False
            self.alive.clear()

    def take_birth(self, message, device):
        metrics = {metric["name"]: metric for metric in message["metrics"]}
        self.need(None not in metrics and len(metrics) == len(message["metrics"]), "names", message)
        if device is None:
            self.names.clear()
            self.values.clear()
            self.alive.clear()
            self.is_online = self.has_birth = True
            self.births.append(metrics["bdSeq"]["value"])
            self.need(metrics["bdSeq"]["type"] == "Int64", "bdSeq", message)
            rebirth = metrics["Node Control/Rebirth"]
            self.need(rebirth["type"] == "Boolean" and rebirth["value"] is False
                      and rebirth["alias"] is None, "rebirth", message)
        else:
            self.need(self.is_online, "a device before its gateway", message)
            self.alive.add(device)
        for name, metric in metrics.items():
            self.need(metric["type"] is not None, "a type", message)
            if metric["alias"] is not None:
                known = self.names.setdefault(metric["alias"], (device, name))
                self.need(known == (device, name), "an alias for two", message)
        self.values[device] = {name: metric["value"] for name, metric in metrics.items()}
        self.properties[device] = {name: metric["properties"] for name, metric in metrics.items()}

    def take_data(self, message, device):
        self.need(device is None or device in self.alive, "data of the dead", message)
        for metric in message["metrics"]:
            self.need(metric["name"] is None, "a name in data", message)
            known = self.names.get(metric["alias"])
            self.need(known is not None and known[0] == device, "an unknown alias", message)
            if known is not None:
                self.values[device][known[1]] = metric["value"]


class SparkplugCase(GatewayCase):
    def setUp(self):
        super().setUp()
        add_users(self.folder, {"north": "n0rth", "scada": "s" * 9})
        # Both connections of a gateway are the same user.
        self.broker = Broker(self)
        (self.folder / "password").write_text("n0rth\n")

    def start_edge_node(self, nodes=NODES, more="", head=""):
        self.buses = self.start_nodes(nodes)
        self.more = more + f"""
[mqtt]
broker = "127.0.0.1:{self.broker.port}"
site = "{SITE}"
name = "north"
password_file = "password"
sparkplug = "{SITE}"
period_min = "100ms"
"""
        self.head = head
        return self.start_again()

    def start_again(self):
        return self.start_gateway(self.buses, self.more, self.head, **self.timing)

    timing = {"stale_after": "1s", "leave_after": "30s"}

    def listen(self):
        """A host that hears all from now on: know(condition) waits until it holds of what the host
        knows."""
        heard = self.start("host", self.as_host(
            "mosquitto_sub", "-q", "1", "-F", "%t %r %q %x", "-t", "spBv1.0/#",
            "-T", "spBv1.0/+/NCMD/#"))
        decoder = subprocess.Popen(["node", CONSUMER / "consumer.js", "decode"], text=True,
                                   stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.addCleanup(decoder.communicate)
        host = Host()
        taken = 0

        def holds(condition):
            nonlocal taken
            lines = heard.log().split("\n")[:-1]
            for line in lines[taken:]:
                decoder.stdin.write(line + "\n")
                decoder.stdin.flush()
                host.take(json.loads(decoder.stdout.readline()))
            taken = len(lines)
            self.assertEqual(host.mistakes, [])
            return condition(host)
        host.know = lambda condition: wait_for("what a host is to know", lambda: holds(condition))
        return host

    def as_host(self, program, *arguments):
        return [program, "-h", "127.0.0.1", "-p", str(self.broker.port), "-u", "scada",
                "-P", "s" * 9, *arguments]

    def publish(self, payload):
        subprocess.run(self.as_host("mosquitto_pub", "-t", f"spBv1.0/{SITE}/NCMD/north", "-s"),
                       input=payload, check=True, timeout=PATIENCE_S)

    def ask_for_births(self, name="Node Control/Rebirth", value="true"):
        command = subprocess.run(["node", CONSUMER / "consumer.js", "command", name, value],
                                 capture_output=True, check=True, timeout=PATIENCE_S).stdout
        self.publish(command)


def has_nodes(*serials):
    return lambda host: host.alive == {str(serial) for serial in serials}


class Sparkplug(SparkplugCase):
    def test_a_host_knows_the_gateway_and_its_nodes(self):
        host = self.listen()
        self.start_edge_node(NODES + ["3000,8,move,-50,91", "3000,8,low_battery,,",
                                      "5000,9,silent,,"])
        host.know(has_nodes(7, 8, 9))
        host.know(lambda host: host.value(None, "Mesh/Nodes") == 3)
        self.assertEqual(host.births, [0])
        seven = host.values["7"]
        self.assertEqual((seven["Position/X"], seven["Position/Y"]), (300, -200))
        self.assertEqual(seven["Position/Fix"], True)
        self.assertEqual(seven["Mesh/In mesh"], True)
        host.know(lambda host: host.value("7", "Mesh/Neighbours") == 2)
        host.know(lambda host: [host.value("8", name) for name in (
            "Position/X", "Position/Y", "Low battery")] == [-50, 91, True])
        header = self.header()
        host.know(lambda host: host.value(None, "Mesh/Hash")
                  == "".join(f"{part:04x}" for part in header["hash"]))
        host.know(has_nodes(7, 8))
        self.assertEqual(host.births, [0])

    def test_a_host_that_comes_later_asks_for_births_and_can_do_nothing_else(self):
        gateway = self.start_edge_node(head=METER, more='[[bus.device]]\nunits = "2"\n'
                                                        'profile = "meter"\n')
        gateway.wait_for_line(r"broker 127\.0\.0\.1:\d+: connected as "
                              rf"{SITE}:north:sparkplug")
        self.wait_for_header(nodes=3)
        host = self.listen()
        # Once it hears itself it hears all.
        wait_for("a host that listens", lambda: self.ask_for_births() or has_nodes(7, 8, 9)(
            self.once(host)))
        self.assertAlmostEqual(host.values["8"]["Readings/magic"], 17.748)
        self.assertEqual(host.properties["8"]["Readings/magic"], {"engUnit": "°C"})
        before = self.header()
        births = len(host.births)
        self.ask_for_births(value="false")
        self.ask_for_births(name="Node Control/Reboot")
        self.publish(os.urandom(2000))
        self.publish(b"\x12" * 300)
        self.ask_for_births()
        host.know(lambda host: len(host.births) > births)
        host.know(has_nodes(7, 8, 9))
        self.assertEqual(set(host.births), {0}, "all of one connection")
        self.assertEqual(self.header(), before)

    def once(self, host):
        host.know(lambda host: True)
        return host

    def test_a_death_is_told_however_it_comes(self):
        host = self.listen()
        gateway = self.start_edge_node()
        host.know(has_nodes(7, 8, 9))
        gateway.process.send_signal(signal.SIGKILL)
        gateway.process.wait()
        host.know(lambda host: host.deaths == [0] and not host.is_online)
        gateway = self.start_again()
        host.know(lambda host: len(host.births) == 2 and has_nodes(7, 8, 9)(host))
        self.broker.stop()
        host.has_birth = False
        gateway.wait_for_line(r"warning: broker .*trying again")
        self.broker.start()
        # Where the host itself is back in time it hears the births, else it asks for them.
        wait_for("births of the next connection", lambda: self.ask_for_births() or (
            self.once(host).births[-1] == 1 and has_nodes(7, 8, 9)(host)))
        self.assertEqual(gateway.stop(), 0)
        host.know(lambda host: host.deaths[-1] == 1 and not host.is_online)


if __name__ == "__main__":
    why = install_consumer()
    if why is not None:
        print(f"skipped: {why}")
        sys.exit(SKIPPED)
    unittest.main()
