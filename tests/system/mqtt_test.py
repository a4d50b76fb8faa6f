"""Gateways at a real broker, Mosquitto, with the configuration and the access list that come with the
package. The programs' folder is in ETCM_BIN."""
import json
import pathlib
import re
import signal
import socket
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from broker import SITE, Broker, add_users
from gateway_test import PROGRAMS, GatewayCase
from programs import PATIENCE_S, free_port, wait_for

USERS = {"north": "n0rth", "south": "s0uth", "viewer": "view", "site": "s1te"}


class MqttCase(GatewayCase):
    def write_secret(self, name, text):
        path = self.folder / name
        path.write_text(text + "\n")
        path.chmod(0o600)
        return path

    def start_member(self, name, port=None, host="127.0.0.1", keys="", user=None, password=None,
                     program=None):
        """A gateway of the site without a bus; its log has lines of its own."""
        program = program or name
        user = user or name
        secret = self.write_secret(f"{program}.password", password or USERS.get(user, "none"))
        config = self.folder / f"{program}.toml"
        config.write_text(f"""
[mesh]
vertices_max = 100
features_max = 10
[server]
listen = "127.0.0.1:0"
[mqtt]
broker = "{host}:{port or self.broker.port}"
site = "{SITE}"
name = "{name}"
share = "site"
user = "{user}"
password_file = "{secret}"
{keys}
""")
        return self.start(program, [PROGRAMS / "etcm-gateway", "--config", config])

    def client(self, program, *arguments, user="viewer", port=None):
        return [program, "-V", "mqttv5", "-h", self.broker.address, "-p", str(port or self.broker.port),
                "-u", user, "-P", USERS[user], *arguments]

    def publish(self, topic, text, user, *arguments):
        done = subprocess.run(self.client("mosquitto_pub", "-q", "1", "-t", topic, "-m", text,
                                          *arguments, user=user),
                              capture_output=True, text=True, timeout=PATIENCE_S)
        return done.stdout + done.stderr

    def header_of(self, name):
        """What the broker keeps of that gateway."""
        done = subprocess.run(self.client("mosquitto_sub", "-C", "1", "-W", str(PATIENCE_S), "-t",
                                          f"etcm/v1/{SITE}/{name}/header"),
                              capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def wait_for_online(self, name, is_online):
        wait_for(f"{name} to be {'online' if is_online else 'gone'}",
                 lambda: self.header_of(name)["online"] == is_online)


class Members(MqttCase):
    def setUp(self):
        super().setUp()
        add_users(self.folder, USERS)
        self.broker = Broker(self)

    def test_each_is_let_in_by_its_password_and_is_known_until_it_ends(self):
        gateways = {name: self.start_member(name) for name in ("north", "south")}
        for name, gateway in gateways.items():
            gateway.wait_for_line(f"connected as {SITE}:{name}")
            self.wait_for_online(name, True)
        # However it ends, the broker tells its last will.
        self.assertEqual(gateways["north"].stop(), 0)
        gateways["south"].process.kill()
        for name in gateways:
            self.wait_for_online(name, False)

    def test_a_session_over_ipv6_is_one_as_any(self):
        self.broker.stop()
        self.broker = Broker(self, name="ipv6", address="::1")
        gateway = self.start_member("north", host="[::1]")
        gateway.wait_for_line(f"connected as {SITE}:north")
        self.wait_for_online("north", True)
        self.broker.stop()
        gateway.wait_for_line(r"broker \[::1\]:\d+: .*; trying again")
        self.broker.start()
        wait_for("a second session", lambda: gateway.log().count(f"as {SITE}:north") == 2)
        gateway.process.kill()
        self.wait_for_online("north", False)

    def test_a_wrong_password_is_told_with_its_cure(self):
        gateway = self.start_member("north", password="wrong")
        gateway.wait_for_line(r"does not let in user 'north'; correct user or password_file, or add "
                              r"the user there; trying again")

    def test_nobody_writes_to_the_topics_of_another(self):
        gateway = self.start_member("south", user="north")
        # Mosquitto 2.0.11 may hang up after the first of them.
        gateway.wait_for_line(rf"message for etcm/v1/{SITE}/south/(set|header|alarms) is refused: "
                              r"its access list does not allow that to user 'north'; allow it there")
        for user, topic in (("north", "south/header"), ("north", "south/node/00000001"),
                            ("viewer", "north/header"), ("viewer", "viewer/header"),
                            ("viewer", "site"), ("south", "site"), ("site", "site")):
            with self.subTest(user=user, topic=topic):
                self.assertIn("Not authorized",
                              self.publish(f"etcm/v1/{SITE}/{topic}", "{}", user))
        for topic in (f"spBv1.0/{SITE}/NDATA/viewer", f"spBv1.0/{SITE}/NCMD/north",
                      "homeassistant/device/x/config"):
            with self.subTest(topic=topic):
                self.assertIn("Not authorized", self.publish(topic, "{}", "viewer"))
        for user, topic in (("north", "north/alarms"), ("north", "site")):
            with self.subTest(user=user, topic=topic):
                self.assertEqual(self.publish(f"etcm/v1/{SITE}/{topic}", "", user, "-r"), "")

    def test_who_may_not_tell_its_site_is_told(self):
        feature = "[[feature]]\nfrom = 1\nto = 2\n"
        self.start_member("south", keys=feature).wait_for_line(
            rf"the broker does not let this gateway tell its site: .*"
            rf"add `topic readwrite etcm/v1/{SITE}/site`")
        north = self.start_member("north", keys=feature)
        north.wait_for_line("connected")
        listened = subprocess.run(
            self.client("mosquitto_sub", "-t", f"etcm/v1/{SITE}/site", "-C", "1", "-W", "30"),
            capture_output=True, text=True, timeout=PATIENCE_S).stdout
        self.assertEqual(json.loads(listened)["gateway"], "north")
        # Mosquitto 2.0.11 hangs up after what it refuses. It is not told again.
        self.wait_for_online("south", True)

    def test_two_gateways_of_one_name_are_both_told_and_both_stay(self):
        keys = 'period_min = "1s"\nperiod_max = "4s"'
        names = ("first", "second")
        programs = [self.start_member("north", program=name, keys=keys) for name in names]
        for gateway in programs:
            gateway.wait_for_line(r"gateway north of the fleet: another gateway uses this name of "
                                  r"\[mqtt\] too; give each its own\. (This|The other) one tells "
                                  "nothing until then")
        logs = [gateway.log() for gateway in programs]
        # Mosquitto 2.0.11 only hangs up; later ones say why. One of them has given way by its id.
        self.assertRegex("".join(logs), rf"another client (may have|has) come as '{SITE}:north'.*"
                                        "give each gateway a name of its own.*; trying again")
        self.assertRegex("".join(logs), rf"connected as {SITE}:north:[0-9a-f]+")
        self.assertEqual(sum("This one tells nothing" in log for log in logs), 1)
        # The one that goes on learns that the other one has been given a name of its own.
        silent = int("This one tells nothing" in logs[1])
        config = self.folder / f"{names[silent]}.toml"
        programs[silent].stop()
        config.write_text(config.read_text().replace('name = "north"', 'name = "south"')
                          .replace('user = "north"', 'user = "south"'))
        self.write_secret(f"{names[silent]}.password", USERS["south"])
        self.start("renamed", [PROGRAMS / "etcm-gateway", "--config", config])
        programs[1 - silent].wait_for_line("no other gateway uses its name any more")
        for name in ("north", "south"):
            self.wait_for_online(name, True)

    def test_where_the_broker_makes_ids_of_users_two_of_a_name_give_way(self):
        self.broker = Broker(self, name="strict", more=("use_username_as_clientid true",))
        first = self.start_member("north")
        first.wait_for_line(f"connected as {SITE}:north")
        second = self.start_member("north", program="other")
        second.wait_for_line(f"connected as {SITE}:north")
        first.wait_for_line(rf"another client (may have|has) come as '{SITE}:north'.* give each "
                            r"gateway a name of its own.*; trying again")

    def test_who_takes_the_place_of_another_has_it_for_a_moment(self):
        gateway = self.start_member("north")
        gateway.wait_for_line(f"connected as {SITE}:north")
        # The broker's word for it, or the second end without one, tells what it was.
        for sessions in range(2, 4):
            done = subprocess.run(self.client("mosquitto_sub", "-i", f"{SITE}:north", "-E", "-t",
                                              f"etcm/v1/{SITE}/#"),
                                  capture_output=True, text=True, timeout=PATIENCE_S)
            self.assertEqual(done.returncode, 0, done.stderr)
            wait_for("it to be back",
                     lambda: gateway.log().count("connected as") >= sessions
                     or re.search(rf"as {SITE}:north:[0-9a-f]+", gateway.log()))
        self.assertRegex(gateway.log(), rf"connected as {SITE}:north:[0-9a-f]+")
        self.wait_for_online("north", True)

    def test_a_broker_that_comes_back_is_found_again(self):
        gateway = self.start_member("north")
        gateway.wait_for_line(f"connected as {SITE}:north")
        self.broker.stop()
        gateway.wait_for_line(r"broker 127\.0\.0\.1:\d+: .*; trying again")
        self.broker.start()
        wait_for("a second connection", lambda: gateway.log().count(f"as {SITE}:north") == 2)

    def test_a_long_time_without_a_word_is_no_reason_to_part(self):
        gateway = self.start_member("north", keys='keep_alive = "5s"')
        gateway.wait_for_line(f"connected as {SITE}:north")
        self.broker.program.wait_for_line(f"Received PINGREQ from {SITE}:north")
        self.assertNotIn("trying again", gateway.log())


class WithoutABroker(MqttCase):
    def test_each_reason_has_its_words(self):
        for program, host, port, words in (
                ("refused", "127.0.0.1", free_port(),
                 "Connection refused; nothing listens there: check address and port"),
                ("unknown", "no-such-host.invalid", 1883,
                 "correct the name, or look at the name server")):
            gateway = self.start_member("north", port, host, program=program)
            gateway.wait_for_line(words + ".*; trying again")

    def test_polling_goes_on(self):
        """While the broker takes the connection and says nothing, also with TLS."""
        buses = self.start_nodes(["0,1,join,0,0", "0,2,join,1000,-5", "500,3,join,400,700"])
        key = self.write_secret("psk", "0123456789abcdef" * 2)
        with socket.socket() as silent:
            silent.bind(("127.0.0.1", 0))
            silent.listen()
            for tls in ("", f'psk_identity = "north"\npsk_file = "{key}"\n'):
                gateway = self.start_gateway(buses, f"""[mqtt]
broker = "127.0.0.1:{silent.getsockname()[1]}"
site = "{SITE}"
name = "north"
{tls}""")
                self.wait_for_header(nodes=3, state=0)
                silent.accept()[0].close()
                gateway.wait_for_line("before it answered; give the port")
                gateway.stop(signal.SIGKILL)


if __name__ == "__main__":
    unittest.main(verbosity=2)
