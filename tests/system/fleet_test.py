"""Several gateways and a broker as processes: real Mosquitto, real Modbus, killed at any moment.

The programs' folder is in ETCM_BIN. ETCM_FLEET_KILLS=50 kills so often in the last test.
"""
import json
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import unittest
import urllib.request

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE.parent / "support"))
sys.path.insert(0, str(HERE))
from broker import EXAMPLES
from programs import PATIENCE_S, ProgramCase, free_port, wait_for

PROGRAMS = pathlib.Path(os.environ["ETCM_BIN"]).resolve()
MOSQUITTO = shutil.which("mosquitto") or "/usr/sbin/mosquitto"
KILLS = int(os.environ.get("ETCM_FLEET_KILLS", "4"))


def grid(first, count, west):
    """Nodes of one gateway: serial to place, no four on a circle."""
    return {first + i: (west + 1000 * (i % 4) + 37 * (i % 7), 1000 * (i // 4) + 53 * (i % 5))
            for i in range(count)}


def shipped_sizes():
    """The lines of the broker's shipped settings that say how much it takes."""
    return [line for line in (EXAMPLES / "mosquitto/etcm.conf").read_text().splitlines(True)
            if line.startswith(("max_", "set_"))]


class FleetCase(ProgramCase):
    leave_after = "60s"
    # A period of the fleet is no longer than that.
    period_max_s = 30

    def setUp(self):
        super().setUp()
        self.broker_port = free_port()
        self.running = {}
        self.runs = {}
        self.pages = {}
        self.features = []
        self.site_file = None

    def launch(self, name, command):
        """The next run of a program; what it said before is in the log of that run."""
        run = self.runs[name] = self.runs.get(name, 0) + 1
        self.running[name] = self.start(f"{name}-{run}", command)
        return self.running[name]

    def halt(self, name, how=signal.SIGTERM):
        return self.running.pop(name).stop(how)

    def start_broker(self, forgets=False):
        (self.folder / "broker").mkdir(exist_ok=True)
        persistence = "persistence false\n" if forgets else (
            f"persistence true\npersistence_location {self.folder}/broker/\n"
            "autosave_interval 1\nautosave_on_changes true\n")
        (self.folder / "broker.conf").write_text(
            f"listener {self.broker_port} 127.0.0.1\nallow_anonymous true\nuser root\n{persistence}"
            + "".join(shipped_sizes()))
        self.launch("broker", [MOSQUITTO, "-c", "broker.conf"])
        wait_for("the broker to listen", self.broker_listens)

    def broker_listens(self):
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.broker_port)) == 0

    vertices_max = 600
    interval = "100ms"
    with_files = ()   # those that write their mesh to out-NAME

    def write_gateway(self, name, buses, share="site", as_name=None):
        """`share`: None where it is not written."""
        features = "".join(f"[[feature]]\nfrom = {a}\nto = {b}\n" for a, b in self.features)
        if self.site_file:
            features += f'[site]\nfile = "{self.site_file}"\ncrs = "plane"\n'
        if name in self.with_files:
            features += f'[files]\nfolder = "out-{name}"\ninterval = "1s"\n'
        (self.folder / f"{name}.toml").write_text(f"""
[mesh]
vertices_max = {self.vertices_max}
features_max = 50
[poll]
interval = "{self.interval}"
timeout = "500ms"
absent_interval = "200ms"
stale_after = "20s"
leave_after = "{self.leave_after}"
[server]
listen = "127.0.0.1:0"
[http]
listen = "127.0.0.1:0"
[state]
folder = "state-{name}"
interval = "1s"
[mqtt]
broker = "127.0.0.1:{self.broker_port}"
site = "site"
name = "{as_name or name}"
period_min = "100ms"
period_max = "{self.period_max_s}s"
{'' if share is None else f'share = "{share}"'}
""" + "".join(f'[[bus]]\ntcp = "{end}"\nunits = "{units}"\n' for end, units in buses) + features)
        (self.folder / f"state-{name}").mkdir(exist_ok=True)

    def run_gateway(self, name):
        gateway = self.launch(name, [PROGRAMS / "etcm-gateway", "--config", f"{name}.toml"])
        self.pages[name] = gateway.wait_for_line(r"shows the status page on (\S+)").group(1)

    def start_nodes(self, name, rows):
        (self.folder / f"{name}.csv").write_text(
            "time_ms,serial,event,x,y\n" + "\n".join(rows) + "\n")
        nodes = self.launch(f"nodes-{name}", [PROGRAMS / "etcm-nodes", "--listen", "127.0.0.1:0",
                                              "--nodes", f"{name}.csv"])
        nodes.wait_for_line(r"ready:")
        return re.findall(r"listens on (\S+) for units (\S+)", nodes.log())

    def start_gateway(self, name, nodes, share="site", as_name=None, more=()):
        rows = [f"0,{serial},join,{x},{y}" for serial, (x, y) in nodes.items()] + list(more)
        buses = self.start_nodes(name, rows) if rows else []
        self.write_gateway(name, buses, share, as_name)
        self.run_gateway(name)

    def read(self, name, document):
        with urllib.request.urlopen(f"{self.pages[name]}/{document}",
                                    timeout=PATIENCE_S) as answer:
            return json.load(answer)

    def status(self, name):
        return self.read(name, "status.json")

    def members(self, name):
        return {member["name"]: member for member in self.status(name)["fleet"]["members"]}

    def places(self, name):
        """Serial to place, of the nodes in its mesh; none may be there twice."""
        found = {}
        for feature in self.read(name, "mesh.json")["features"]:
            properties = feature["properties"]
            if properties["kind"] == "node" and properties["in_mesh"]:
                self.assertNotIn(properties["serial"], found)
                found[properties["serial"]] = tuple(feature["geometry"]["coordinates"])
        return found

    def agree(self, names, nodes):
        """Whether all have these nodes, fresh, and one mesh; its hash then."""
        hashes = set()
        for name in names:
            status = self.status(name)
            fleet = status["fleet"]
            if (status["nodes"] != len(nodes) or status["stale_nodes"] or not fleet["connected"] or
                    fleet["agreeing"] != len(names) or len(fleet["members"]) != len(names)):
                return None
            hashes |= {member["mesh_hash"] for member in fleet["members"]}
        if len(hashes) != 1 or any(self.places(name) != nodes for name in names):
            return None
        return hashes.pop()

    def wait_for_agreement(self, names, nodes, patience_s=PATIENCE_S):
        return wait_for(f"{names} to agree", lambda: self.agree(names, nodes), patience_s)


class Sharing(FleetCase):
    def written(self, name):
        """Serial to place, of the nodes in the files of its mesh; none while there are none."""
        path = self.folder / f"out-{name}" / "mesh.node"
        text = path.read_text() if path.exists() else ""
        rows = [line.split() for line in text.splitlines() if line.strip() and line[0] != "#"]
        return {int(row[3]): (int(float(row[1])), int(float(row[2]))) for row in rows[1:]}

    def test_gateways_and_an_office_have_one_mesh(self):
        west, east = grid(1, 12, 0), grid(101, 12, 5000)
        self.with_files = ("office",)
        self.features = [(1, 101), (12, 108)]
        self.start_broker()
        self.start_gateway("west", west)
        self.start_gateway("east", east)
        self.start_gateway("office", {})
        self.wait_for_agreement(["west", "east", "office"], west | east)
        owners = {feature["properties"]["serial"]: feature["properties"].get("owner")
                  for feature in self.read("office", "mesh.json")["features"]
                  if feature["properties"]["kind"] == "node"}
        self.assertEqual(owners, {serial: "west" for serial in west} |
                         {serial: "east" for serial in east})
        self.assertEqual(self.status("office")["features_active"], 2)
        wait_for("the files of the office",
                 lambda: (west | east).items() <= self.written("office").items())
        self.assertTrue((self.folder / "out-office" / "mesh.ele").exists())
        port = re.search(r"serves the mesh on \S+:(\d+)", self.running["office"].log()).group(1)
        count = subprocess.run(["mbpoll", "-m", "tcp", "-p", port, "-a", "1", "-t", "3:hex", "-0",
                                "-r", "10", "-c", "2", "-1", "127.0.0.1"], capture_output=True,
                               text=True, timeout=PATIENCE_S).stdout
        self.assertIn("0x0018", count)   # 24 nodes

    def draw(self, places, serials):
        """A site file with one line; where it has no serial it has an anchor."""
        line = {"type": "Feature", "properties": {"serials": serials, "name": "fence"},
                "geometry": {"type": "LineString", "coordinates": places}}
        (self.folder / "site.geojson").write_text(
            json.dumps({"type": "FeatureCollection", "features": [line]}))

    def lines(self, name):
        """The segments of features that are in its mesh, and the number of the site."""
        status = self.status(name)
        return status["features_active"], status["fleet"].get("site_number", 0)

    def test_the_site_file_of_one_is_in_all_meshes(self):
        west, east = grid(1, 12, 0), grid(101, 12, 5000)
        everyone = ["west", "east", "office"]
        self.start_broker()
        self.draw([[0, 0], [4500, 700], [5100, 100]], [1, None, 101])
        self.site_file = "site.geojson"
        self.start_gateway("west", west)
        self.site_file = None
        self.start_gateway("east", east)
        self.start_gateway("office", {})
        self.wait_for_agreement(everyone, west | east)
        wait_for("the site of west in all", lambda: all(
            self.lines(name) == (2, 1) for name in everyone))

        # The broker starts again, with what it had kept; then it has forgotten all.
        for forgets in (False, True):
            self.halt("broker", signal.SIGKILL)
            wait_for("all to see that", lambda: not any(
                self.status(name)["fleet"]["connected"] for name in everyone))
            self.start_broker(forgets)
            self.wait_for_agreement(everyone, west | east)
            for name in everyone:
                self.assertEqual(self.lines(name), (2, 1))

        # Who starts again while there is no broker has it from its disk.
        self.halt("broker", signal.SIGKILL)
        self.assertEqual(self.halt("office"), 0)
        self.run_gateway("office")
        wait_for("the office to have it from its disk", lambda: self.lines("office") == (2, 1))
        self.start_broker()

        # A change of the file is in all of them after a reload.
        self.draw([[0, 0], [5100, 100]], [1, 101])
        self.running["west"].process.send_signal(signal.SIGHUP)
        wait_for("the change in all", lambda: all(
            self.lines(name) == (1, 2) for name in everyone))
        self.wait_for_agreement(everyone, west | east)

    def test_the_plane_of_one_is_that_of_all_and_tells_degrees(self):
        self.start_broker()
        for name, first, more in (
                ("west", 1, '[site]\ncrs = "EPSG:25833"\norigin = ["569000", "7034000"]\n'
                            "[[feature]]\nfrom = 1\nto = 2\n"),
                ("east", 101, "")):
            rows = [f"0,{serial},join,{x},{y}" for serial, (x, y) in grid(first, 4, first).items()]
            self.write_gateway(name, self.start_nodes(name, rows))
            path = self.folder / f"{name}.toml"
            key = 'share = "site"\n'
            path.write_text(path.read_text().replace(
                key, key + 'home_assistant = "homeassistant"\n') + more)
            self.run_gateway(name)

        def told(topic):
            done = subprocess.run(["mosquitto_sub", "-h", "127.0.0.1", "-p", str(self.broker_port),
                                   "-t", topic, "-C", "1", "-W", "2"],
                                  capture_output=True, text=True, timeout=PATIENCE_S)
            return done.stdout
        wait_for("degrees of a node of east", lambda: '"latitude"' in told(
            "etcm/v1/site/east/node/00000065"))
        wait_for("Home Assistant to be told of them", lambda: "value_json.latitude" in told(
            "homeassistant/device/etcm_site_101/config"))

    def test_who_only_publishes_has_a_mesh_of_its_own(self):
        west, east = grid(1, 6, 0), grid(101, 6, 5000)
        self.start_broker()
        self.start_gateway("west", west, share="publish")
        self.start_gateway("east", east)
        wait_for("east to have all", lambda: self.places("east") == west | east)
        self.assertEqual(self.places("west"), west)

    def test_what_changed_without_the_broker_is_there_after_it(self):
        west, east = grid(1, 8, 0), grid(101, 8, 5000)
        self.start_broker()
        joins = [f"{4000 + 100 * i},{201 + i},join,{9000 + 700 * i},{400 * i}" for i in range(5)]
        self.start_gateway("west", west, more=joins)
        self.start_gateway("east", east)
        self.start_gateway("office", {})
        self.halt("broker", signal.SIGKILL)
        wait_for("the office to see that", lambda: not self.status("office")["fleet"]["connected"])
        late = {201 + i: (9000 + 700 * i, 400 * i) for i in range(5)}
        wait_for("west to have its late nodes", lambda: late.items() <= self.places("west").items())
        self.assertFalse(late.keys() & self.places("office").keys())
        self.start_broker()
        self.wait_for_agreement(["west", "east", "office"], west | east | late)

    def test_a_broker_that_forgot_everything_is_told_again(self):
        west, east = grid(1, 8, 0), grid(101, 8, 5000)
        self.start_broker(forgets=True)
        self.start_gateway("west", west)
        self.start_gateway("east", east)
        self.wait_for_agreement(["west", "east"], west | east)
        self.halt("broker", signal.SIGKILL)
        self.start_broker(forgets=True)
        self.start_gateway("office", {})
        self.wait_for_agreement(["west", "east", "office"], west | east)

    def test_the_second_with_a_name_is_told_and_harms_nobody(self):
        west, other = grid(1, 8, 0), grid(301, 4, 9000)
        self.start_broker()
        self.start_gateway("west", west)
        self.start_gateway("office", {})
        self.wait_for_agreement(["west", "office"], west)
        self.start_gateway("copy", other, as_name="west")
        for name in ("west", "copy"):
            self.running[name].wait_for_line("name")
        self.running["copy"].wait_for_line("This one tells nothing until then")
        wait_for("the first one's nodes to be there", lambda: self.places("office") == west)
        self.halt("copy")
        self.wait_for_agreement(["west", "office"], west)

    def test_nonsense_is_named_and_harms_nobody(self):
        west = grid(1, 8, 0)
        self.start_broker()
        self.start_gateway("west", west)
        self.start_gateway("office", {})
        self.wait_for_agreement(["west", "office"], west)
        for topic, payload in [("etcm/v1/site/liar/header", "{"),
                               ("etcm/v1/site/liar/node/00000001", "[[[[[[[[[[[[[[[["),
                               ("etcm/v1/site/liar/node/zzzz", "x" * 5000),
                               ("etcm/v1/site//node/00000001", "{}"),
                               ("etcm/v1/site/west/node/00000001/more/levels", "null")]:
            subprocess.run(["mosquitto_pub", "-p", str(self.broker_port), "-q", "1", "-r", "-t",
                            topic, "-m", payload], check=True, timeout=PATIENCE_S)
        self.running["office"].wait_for_line("liar")
        wait_for("the office to have its mesh", lambda: self.places("office") == west)


class Many(FleetCase):
    vertices_max = 3000
    interval = "2s"

    def test_who_comes_late_learns_more_nodes_than_a_broker_queues_by_itself(self):
        nodes = grid(1, 1200, 0)
        self.start_broker()
        self.start_gateway("west", nodes)
        self.wait_for_agreement(["west"], nodes)
        self.start_gateway("office", {})
        self.wait_for_agreement(["west", "office"], nodes)


class Deaths(FleetCase):
    leave_after = "2s"

    def test_the_nodes_of_a_dead_gateway_leave_and_return_with_it(self):
        west, east = grid(1, 8, 0), grid(101, 8, 5000)
        self.start_broker()
        self.start_gateway("west", west)
        self.start_gateway("east", east)
        self.start_gateway("office", {})
        self.wait_for_agreement(["west", "east", "office"], west | east)
        self.halt("east", signal.SIGKILL)
        wait_for("the office to see it", lambda: self.members("office")["east"]["state"] == "gone")
        wait_for("its nodes to leave", lambda: self.places("office") == west)
        wait_for("west too", lambda: self.places("west") == west)
        self.run_gateway("east")
        self.wait_for_agreement(["west", "east", "office"], west | east)


class Killing(FleetCase):
    def wait_two_periods_for_agreement(self, names, nodes, what):
        """From the last fault, when all run again; firmware/fleet/README.md has this bound."""
        began = time.monotonic()
        self.wait_for_agreement(names, nodes, 2 * self.period_max_s)
        print(f"{what}: agreed after {time.monotonic() - began:.1f} s")

    def kill_while_the_broker_is_away(self, victim):
        self.halt("broker", signal.SIGKILL)
        wait_for("it to see that", lambda: not self.status(victim)["fleet"]["connected"])
        self.halt(victim, signal.SIGKILL)
        self.run_gateway(victim)
        self.start_broker()

    def test_killed_while_the_broker_is_away_a_gateway_comes_back_to_the_same_mesh(self):
        west, east = grid(1, 12, 0), grid(101, 12, 5000)
        everyone = ["west", "east", "office"]
        self.start_broker()
        self.start_gateway("west", west)
        self.start_gateway("east", east)
        self.start_gateway("office", {})
        self.wait_for_agreement(everyone, west | east)
        for victim in ("west", "office"):
            self.kill_while_the_broker_is_away(victim)
            self.wait_two_periods_for_agreement(everyone, west | east, victim)

    def test_killed_at_random_under_load_nothing_is_lost_and_nothing_doubled(self):
        names = ["a", "b", "c", "d"]
        everyone = [*names, "office"]
        random_number = random.Random(20)
        truth = {}
        seconds = 6 + KILLS
        self.start_broker()
        for number, name in enumerate(names):
            nodes = grid(100 * number + 1, 20, 6000 * number)
            moves = []
            for at_ms in range(1000, 1000 * seconds, 100):
                serial = random_number.choice(list(nodes))
                x, y = nodes[serial][0] + random_number.randrange(300), nodes[serial][1] + \
                    random_number.randrange(300)
                moves.append((at_ms, serial, x, y))
            self.start_gateway(name, nodes,
                               more=[f"{t},{serial},move,{x},{y}" for t, serial, x, y in moves])
            truth |= nodes | {serial: (x, y) for _, serial, x, y in moves}
        moved_at = time.monotonic() + seconds
        self.start_gateway("office", {})
        for kill in range(KILLS):
            if kill == KILLS // 2:
                self.kill_while_the_broker_is_away(random_number.choice(everyone))
                continue
            victim = random_number.choice([*everyone, "broker"])
            self.halt(victim, signal.SIGKILL)
            if random_number.random() < 0.5:
                other = random_number.choice([name for name in everyone if name != victim])
                self.halt(other, signal.SIGKILL)
                self.run_gateway(other)
            if victim == "broker":
                self.start_broker()
            else:
                self.run_gateway(victim)
        time.sleep(max(0.0, moved_at - time.monotonic()))
        self.wait_two_periods_for_agreement(everyone, truth, f"{KILLS} kills")
        for name in everyone:
            self.assertEqual(self.halt(name), 0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
