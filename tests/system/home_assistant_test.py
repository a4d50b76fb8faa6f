"""The nodes as devices of Home Assistant, for real: Mosquitto between the gateway and a consumer that
keeps to what Home Assistant documents of its MQTT discovery, templates by Jinja as it has them. The
programs' folder is in ETCM_BIN."""
import json
import pathlib
import re
import sys
import unittest

import jinja2
import jinja2.sandbox

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from broker import SITE, Broker, add_users
from gateway_test import SOON, GatewayCase
from programs import wait_for

# What is documented of the platforms that may come: what each needs, and what else it may have.
COMMON = {"platform", "name", "unique_id", "entity_category", "device_class", "availability",
          "json_attributes_topic", "json_attributes_template"}
PLATFORMS = {
    "sensor": ({"state_topic"}, {"value_template", "unit_of_measurement", "state_class"}),
    "binary_sensor": ({"state_topic"}, {"value_template", "payload_on", "payload_off"}),
    # `state_topic` is deprecated for it, and will be gone.
    "device_tracker": ({"json_attributes_topic"}, {"source_type"}),
}
BINARY_CLASSES = {"battery", "connectivity", "problem"}

# A name that is not there is a warning in the log of Home Assistant each time: here it fails.
JINJA = jinja2.sandbox.ImmutableSandboxedEnvironment(undefined=jinja2.StrictUndefined)


def render(template, payload):
    return JINJA.from_string(template).render(value=payload, value_json=json.loads(payload))


def is_topic(text):
    return bool(text) and not set(text) & set("+#\0")


class HomeAssistant:
    """Devices by their topic, and the last payload of every other topic."""

    def __init__(self, case):
        self.case = case
        self.devices = {}
        self.payloads = {}

    def take(self, topic, payload):
        match = re.fullmatch(r"homeassistant/device/([a-zA-Z0-9_-]+)/config", topic)
        if match is None:
            self.case.assertFalse(topic.startswith("homeassistant/"), topic)
            self.payloads[topic] = payload
        elif not payload:
            self.devices.pop(match.group(1), None)
        else:
            self.devices[match.group(1)] = self.checked(json.loads(payload))

    def checked(self, config):
        case = self.case
        case.assertLessEqual(set(config), {"device", "origin", "components", "availability"})
        case.assertTrue(config["device"]["identifiers"])
        case.assertLessEqual(set(config["device"]), {"identifiers", "name", "serial_number"})
        case.assertTrue(config["origin"]["name"])
        for source in config["availability"]:
            case.assertTrue(is_topic(source["topic"]))
        ids = set()
        for key, entity in config["components"].items():
            needed, more = PLATFORMS[entity["platform"]]
            case.assertLessEqual(needed | {"unique_id"}, set(entity), key)
            case.assertLessEqual(set(entity), needed | more | COMMON, key)
            case.assertTrue(all(is_topic(entity[name]) for name in needed), key)
            case.assertNotIn(entity["unique_id"], ids)
            ids.add(entity["unique_id"])
            if entity["platform"] == "binary_sensor":
                case.assertIn(entity["device_class"], BINARY_CLASSES)
        return config

    def is_available(self, device):
        [source] = self.devices[device]["availability"]
        payload = self.payloads.get(source["topic"])
        if payload is None:
            return False
        state = render(source["value_template"], payload)
        self.case.assertIn(state, ("online", "offline"))
        return state == "online"

    def state(self, device, name):
        """Of the entity with this name, as Home Assistant would show it; None: unknown."""
        [entity] = [entity for entity in self.devices[device]["components"].values()
                    if entity["name"] == name]
        if entity["platform"] == "device_tracker":
            payload = self.payloads.get(entity["json_attributes_topic"])
            if payload is None:
                return None
            place = json.loads(render(entity["json_attributes_template"], payload))
            return (place["latitude"], place["longitude"]) if place else None
        payload = self.payloads.get(entity["state_topic"])
        if not payload:
            return None
        text = render(entity["value_template"], payload)
        if entity["platform"] == "binary_sensor":
            return {"ON": True, "OFF": False}[text]
        # What is no number is refused where the state is measured.
        return None if text == "None" else float(text)


METER = """
[[profile]]
name = "meter"
function = 4
serial = { register = 2, type = "u32" }
x = { register = 5, type = "i32" }
y = { register = 7, type = "i32" }
[[profile.reading]]
name = "it's \\"magic\\""
unit = "°C"
value = { register = 0, type = "u16", scale = "0.001" }
[[profile.reading]]
name = "never"
value = { register = 0, type = "u16", range = ["0", "1"] }
"""
DEGREES = '[site]\ncrs = "EPSG:25833"\norigin = ["569000", "7034000"]\n'


class AsHomeAssistantDoes(GatewayCase):
    def setUp(self):
        super().setUp()
        add_users(self.folder, {"north": "n0rth", "home": "h0me"})
        self.broker = Broker(self)
        (self.folder / "password").write_text("n0rth\n")

    def listen(self):
        heard = self.start("home", ["mosquitto_sub", "-h", "127.0.0.1", "-p", self.broker.port,
                                    "-u", "home", "-P", "h0me", "-F", "%t %x",
                                    "-t", "#"])
        home = HomeAssistant(self)
        taken = 0

        def know(what, condition):
            nonlocal taken

            def holds():
                nonlocal taken
                lines = heard.log().split("\n")[:-1]
                for line in lines[taken:]:
                    topic, text = line.split(" ")
                    home.take(topic, bytes.fromhex(text).decode())
                taken = len(lines)
                return condition()
            return wait_for(what, holds)
        home.know = know
        return home

    def start_fleet_member(self, nodes, head="", more="", **timing):
        self.buses = self.start_nodes(nodes)
        more += f"""
[mqtt]
broker = "127.0.0.1:{self.broker.port}"
site = "{SITE}"
name = "north"
password_file = "password"
period_min = "100ms"
home_assistant = "homeassistant"
"""
        return self.start_gateway(self.buses, more, head, **timing)

    def test_nodes_are_devices_with_all_that_they_measure(self):
        home = self.listen()
        gateway = self.start_fleet_member(
            ["0,7,join,300,-200", "0,8,join,-40,90", "3000,7,move,310,-200"],
            head=METER + DEGREES, more='[[bus.device]]\nunits = "2"\nprofile = "meter"\n')
        seven, eight = f"etcm_{SITE}_7", f"etcm_{SITE}_8"
        home.know("both devices", lambda: {seven, eight} <= set(home.devices))
        home.know("the header", lambda: home.is_available(seven))
        self.assertEqual(home.devices[seven]["device"]["name"], "Node 7")
        home.know("the place of 7", lambda: [home.state(seven, name) for name in ("X", "Y")]
                  == [310, -200])
        latitude, longitude = home.state(seven, "Position")
        self.assertAlmostEqual(latitude, 63.42, delta=0.02)
        self.assertAlmostEqual(longitude, 16.39, delta=0.02)
        self.assertEqual([home.state(seven, name) for name in (
            "Connection", "Position fix", "Battery")], [True, False, False])
        home.know("what 8 measures", lambda: home.state(eight, 'it\'s "magic"') == 17.748)
        self.assertIsNone(home.state(eight, "never"))
        [magic] = [entity for entity in home.devices[eight]["components"].values()
                   if entity["name"] == 'it\'s "magic"']
        self.assertEqual(magic["unit_of_measurement"], "°C")
        gateway.process.kill()
        home.know("its last will", lambda: not home.is_available(seven))
        # Whoever comes later finds all of it in the broker.
        late = self.listen()
        late.know("both devices", lambda: {seven, eight} <= set(late.devices))
        self.assertEqual(late.state(seven, "X"), 310)

    def test_a_node_that_is_silent_is_not_connected_and_one_that_is_dismissed_has_gone(self):
        home = self.listen()
        gateway = self.start_fleet_member(["0,7,join,300,-200", "0,8,join,-40,90",
                                           "2000,8,low_battery,,", "4000,7,silent,,"], **SOON)
        seven, eight = f"etcm_{SITE}_7", f"etcm_{SITE}_8"
        home.know("both devices", lambda: {seven, eight} <= set(home.devices))
        home.know("that 7 is connected", lambda: home.state(seven, "Connection") is True)
        self.assertFalse(any(entity["platform"] == "device_tracker"
                             for entity in home.devices[seven]["components"].values()))
        home.know("the battery of 8", lambda: home.state(eight, "Battery") is True)
        home.know("that 7 is silent", lambda: home.state(seven, "Connection") is False)
        gateway.wait_for_line(r"node 7 is missing")
        self.assertIn(seven, home.devices)
        # A broker that has kept nothing.
        self.broker.stop()
        home.devices.clear()
        home.payloads.clear()
        self.broker.start()
        gateway.wait_for_line(rf"(?s)trying again.*connected as {SITE}:north")
        home.know("both devices again", lambda: {seven, eight} == set(home.devices))
        home.know("the battery of 8 again", lambda: home.state(eight, "Battery") is True)
        self.assertEqual(self.ctl("dismiss", "7").returncode, 0)
        gateway.wait_for_line(r"node 7 is no longer missed")
        home.know("that 7 has gone", lambda: set(home.devices) == {eight})


if __name__ == "__main__":
    unittest.main()
