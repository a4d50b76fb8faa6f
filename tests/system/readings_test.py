"""What devices measure, from pymodbus to the page, the metrics, the files and a master; the values
change, are not valid, and a device falls silent.

ETCM_BIN is the programs' folder; ETCM_SCREENSHOTS, where it is set, a folder for screenshots.
"""
import json
import math
import re
import signal
import struct
import unittest

from pymodbus.client import ModbusTcpClient
from selenium.webdriver.support.ui import Select

from browser import BrowserCase, PageCase
from gateway_test import SOON, wait_for
from measuring import INVALID, PROFILE, Tanks

SQUARE = [(0, 0), (1000, 0), (1000, 800), (0, 800)]


class MeasuringCase(PageCase):
    def start_tanks(self, places, levels, more="", **times):
        self.tanks = Tanks(self, places)
        self.tanks.set(levels)
        gateway = self.start_gateway([], self.HTTP + self.tanks.settings + more, head=PROFILE, **times)
        self.url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        return gateway

    def json(self, path):
        return json.loads(self.get(path))

    def levels(self):
        """{serial: (value, is stale)}"""
        return {serial: (value, stale) for serial, quantity, value, _, stale, _, _
                in self.json("/readings.json")["readings"] if quantity == 0}

    def wait_for_levels(self, wanted):
        wait_for(f"levels {wanted}", lambda: self.levels() == wanted)

    def metrics(self, name):
        found = re.findall(rf'^{name}\{{name="level",unit="m",serial="(\d+)"\}} (\S+)$',
                           self.get("/metrics").decode(), re.M)
        return {int(serial): float(value) for serial, value in found}


class ForPrograms(MeasuringCase):
    def test_values_change_go_invalid_and_a_device_falls_silent(self):
        self.start_tanks(SQUARE[:3], {1: 1500, 2: -250, 3: INVALID}, **SOON)
        self.wait_for_header(nodes=3)
        self.wait_for_levels({101: (1.5, False), 102: (-0.25, False), 103: (None, False)})
        self.assertEqual(self.metrics("etcm_reading"), {101: 1.5, 102: -0.25})
        generation = self.header()["generation"]
        self.tanks.set({1: 1501, 3: 7})
        self.wait_for_levels({101: (1.501, False), 102: (-0.25, False), 103: (0.007, False)})
        self.tanks.set({2: INVALID})
        self.wait_for_levels({101: (1.501, False), 102: (None, False), 103: (0.007, False)})
        self.assertEqual(self.header()["generation"], generation, "values make no generation")
        self.tanks.set({1: None})
        self.wait_for_levels({101: (1.501, True), 102: (None, False), 103: (0.007, False)})
        wait_for("its metric to end", lambda: self.metrics("etcm_reading") == {103: 0.007})
        self.assertGreater(self.metrics("etcm_reading_age_seconds")[101], 1)
        properties = lambda: {f["properties"].get("serial"): f["properties"]
                              for f in self.json("/mesh.geojson")["features"]}
        wait_for("a missing node with a stale reading", lambda: (
            lambda node: node.get("missing") and node.get("stale reading level (m)") == 1.501
            and "reading level (m)" not in node)(properties()[101]))
        self.assertEqual(properties()[103]["reading temperature (°C)"], 21.5)
        self.tanks.set({1: 2000})
        self.wait_for_levels({101: (2, False), 102: (None, False), 103: (0.007, False)})


    def test_the_files_have_them(self):
        gateway = self.start_tanks(SQUARE, {1: 1500, 2: -250, 3: INVALID, 4: 7}, **SOON)
        gateway.wait_for_line(r"writes out/mesh\.node, \.ele, \.svg and \.geojson")
        path = self.folder / "out" / "mesh.geojson"
        wait_for("the file", path.exists)

        def nodes():
            features = json.loads(path.read_text())["features"]
            return {f["properties"]["serial"]: f["properties"] for f in features
                    if f["properties"]["kind"] == "node"}
        wait_for("a value", lambda: nodes().get(101, {}).get("reading level (m)") == 1.5)
        wait_for("no value", lambda: nodes().get(103, {}).get("reading level (m)", 0) is None)
        self.tanks.set({1: 1501})
        wait_for("another value", lambda: nodes()[101].get("reading level (m)") == 1.501)
        self.tanks.set({4: None})
        wait_for("a stale value, or none of a node that left",
                 lambda: "reading level (m)" not in nodes().get(104, {}))

    def test_a_reload_adds_devices_and_what_they_measure(self):
        """First a site that measures nothing, then one tank, then another bus with a quantity of its own."""
        self.tanks = Tanks(self, SQUARE)
        self.tanks.set({1: 1500, 2: -250, 3: 7, 4: 9})
        [(nodes, _)] = self.start_nodes(["0,1,join,300,300"])
        gateway = self.start_gateway([(nodes, "1")], self.HTTP, **SOON)
        self.url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        self.wait_for_header(nodes=1)
        self.assertEqual(self.json("/readings.json")["quantities"], [])
        config = self.folder / "site.toml"
        began = config.read_text()

        def reread(text, expected):
            seen = gateway.log().count(expected)
            config.write_text(text)
            gateway.process.send_signal(signal.SIGHUP)
            wait_for(expected, lambda: gateway.log().count(expected) > seen)

        one = PROFILE + began + self.tanks.settings.replace('"1-4"', '"1-3"').rsplit("[[node]]", 1)[0]
        reread(one, "3 units more than before")
        self.wait_for_levels({101: (1.5, False), 102: (-0.25, False), 103: (0.007, False)})
        all_of_them = PROFILE + began + self.tanks.settings
        reread(all_of_them, "1 unit more than before")
        self.wait_for_levels({101: (1.5, False), 102: (-0.25, False), 103: (0.007, False),
                              104: (0.009, False)})
        second = Tanks(self, [(500, 500)], name="second", first=200)
        second.set({1: 12})
        other = PROFILE.replace('"tank"', '"other"').replace("temperature", "warmth")
        everything = all_of_them + second.settings.replace('"tank"', '"other"') + other
        reread(everything, "1 unit more than before")
        self.wait_for_levels({101: (1.5, False), 102: (-0.25, False), 103: (0.007, False),
                              104: (0.009, False), 201: (0.012, False)})
        self.assertEqual([quantity["name"] for quantity in self.json("/readings.json")["quantities"]],
                         ["level", "temperature", "warmth"])
        self.assertEqual(self.metrics("etcm_reading")[201], 0.012)
        path = self.folder / "out" / "mesh.geojson"
        wait_for("the file", lambda: path.exists() and "reading warmth" in path.read_text())
        reread(everything.replace('scale = "0.001"', 'scale = "0.01"'),
               'needs a restart: [[profile]] name = "tank"')
        self.tanks.set({1: 1501})
        wait_for("the old scale", lambda: self.levels()[101] == (1.501, False))
        self.assertEqual(gateway.log().count(f"connected to {nodes}"), 1)
        self.assertEqual(gateway.stop(), 0, gateway.log())
        self.assertIn("audit passed", gateway.log())

    def test_a_master_reads_them(self):
        self.start_tanks(SQUARE[:3], {1: 1500, 2: -250, 3: INVALID}, **SOON)
        self.wait_for_header(nodes=3)
        self.wait_for_levels({101: (1.5, False), 102: (-0.25, False), 103: (None, False)})
        long = lambda registers, at: registers[at] << 16 | registers[at + 1]
        text = lambda registers: struct.pack(f">{len(registers)}H", *registers).rstrip(b"\0").decode()

        def table(master):
            """{(serial, quantity): (value, exact value, flags)}, over one connection."""
            read = lambda first, count: master.read_input_registers(first, count, slave=1).registers
            generation = long(read(0, 120), 0)
            block = long(read(109, 2), 0)
            head = read(block * 120, 21)
            self.assertEqual(long(head, 0), generation)
            quantities = [read(long(head, 11) * 120 + 2 + 36 * n, 36) for n in range(long(head, 9))]
            quantities = [(text(q[:24]), text(q[24:])) for q in quantities]
            found = {}
            for n in range(long(head, 16)):
                blocks = read((long(head, 18) + n // 8) * 120, 120)
                self.assertEqual(blocks[:4], head[:4], "of one generation and sequence")
                entry = blocks[4 + n % 8 * 14:][:14]
                value, = struct.unpack(">f", struct.pack(">HH", *entry[6:8]))
                nano, = struct.unpack(">q", struct.pack(">4H", *entry[8:12]))
                found[long(entry, 0), quantities[entry[4] - 1]] = (
                    None if math.isnan(value) else value, nano, entry[5])
            return found

        level, none = ("level", "m"), -2 ** 63
        master = ModbusTcpClient("127.0.0.1", port=self.port)
        self.assertTrue(master.connect())
        found = table(master)
        self.assertEqual(len(found), 6)
        self.assertEqual(found[101, level], (1.5, 1_500_000_000, 0))
        self.assertEqual(found[102, level], (-0.25, -250_000_000, 0))
        self.assertEqual(found[103, level], (None, none, 2))
        self.assertEqual(found[103, ("temperature", "°C")], (21.5, 21_500_000_000, 0))
        self.tanks.set({1: None, 3: 9})
        self.wait_for_levels({101: (1.5, True), 102: (-0.25, False), 103: (0.009, False)})
        wait_for("a stale reading", lambda: table(master)[101, level] == (None, 1_500_000_000, 1))
        self.assertEqual(table(master)[103, level][1], 9_000_000)
        # The same by libmodbus.
        self.assertEqual(self.read(1, self.read(1, 109, 2)[1] * 120 + 8, 1), [3])
        master.close()


class OnTheMap(BrowserCase, MeasuringCase):
    def choose(self, text):
        Select(self.find("#quantity")).select_by_visible_text(text)

    def bands(self):
        return self.text("#bands").splitlines()

    def watch(self):
        """What the browser complained about must be nothing."""
        self.assertEqual([entry for entry in self.browser.get_log("browser")
                          if entry["level"] == "SEVERE"], [])

    def test_a_quantity_is_chosen_and_followed(self):
        self.start_tanks(SQUARE + [(480, 390)], {1: 0, 2: 4000, 3: 8000, 4: 4000, 5: 4100},
                         "[[feature]]\nfrom = 101\nto = 103\n", **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#quantity", r"(?s)No readings.*level \(m\).*temperature")
        self.wait_for_text("#counts", r"Nodes\s*5")
        self.wait_for_text("#state", r"^All well$")
        bare = self.picture()
        self.choose("level (m)")
        wait_for("round bands", lambda: self.bands() == [
            f"{low} … {low + 1} m" for low in range(7, -1, -1)])
        self.wait_for_text("#measured-count", r"^5 nodes$")
        shaded = self.wait_for_another_picture(bare)
        self.screenshot("readings")
        # A value below zero, one that is not valid, one that is stale.
        self.tanks.set({1: -3000})
        wait_for("bands below zero", lambda: self.bands()[-1] == "-4 … -2 m")
        self.tanks.set({2: INVALID})
        self.wait_for_text("#measured-count", r"^4 nodes, 1 without a value$")
        self.tanks.set({3: None})
        self.wait_for_text("#measured-count", r"^3 nodes, 1 stale, 1 without a value$")
        self.screenshot("readings-stale")
        # The same value everywhere, and one alone.
        self.tanks.set({1: 1250, 4: 1250, 5: 1250})
        wait_for("one band", lambda: self.bands() == ["1.25 m"])
        self.tanks.set({1: INVALID, 4: INVALID})
        self.wait_for_text("#measured-count", r"^1 node, 1 stale, 3 without a value$")
        self.assertEqual(self.bands(), ["1.25 m"])
        self.screenshot("readings-one")
        self.tanks.set({5: INVALID})
        wait_for("no band", lambda: self.bands() == [])
        # The details have the exact value of each quantity.
        self.tanks.set({5: 1251})
        self.find("tr[data-serial='105'] button").click()
        self.wait_for_text("#facts", r"(?s)level\s+1\.251 m, .* ago.*temperature\s+21\.5 °C")
        self.choose("No readings")
        wait_for("no bands", lambda: self.bands() == [] and self.text("#measured-count") == "")
        self.watch()

    def test_two_sensors_shade_no_area_and_names_stay_on_the_map(self):
        self.start_tanks(SQUARE + [(480, 390)], {1: 0, 2: 4000, 3: INVALID, 4: INVALID, 5: INVALID},
                         '[[node]]\nserial = 102\nname = "east tank"\n', **SOON)
        self.size(1280, 800)
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*5")
        self.choose("level (m)")
        self.wait_for_text("#measured-count", r"^2 nodes, 3 without a value$")
        shaded = lambda: self.browser.execute_async_script("""
            const done = arguments[0];
            Promise.all(["model", "readings", "shading"].map((name) => import(`./${name}.js`)))
              .then(async ([{ readMesh }, { readReadings }, { Shading }]) => {
                const get = async (path) => (await fetch(path)).json();
                const mesh = readMesh(await get("mesh.json"));
                const readings = readReadings(await get("readings.json"));
                done(new Shading(mesh, readings.quantities[0], readings.ofQuantity[0]).shaded.length);
              });""")
        self.assertEqual(shaded(), 0)
        self.screenshot("readings-two")
        self.tanks.set({5: 2000})
        self.wait_for_text("#measured-count", r"^3 nodes, 2 without a value$")
        self.assertGreater(shaded(), 0)
        label = self.browser.execute_async_script("""
            const done = arguments[0];
            import("./map.js").then(({ MeshMap }) => {
              const map = { shading: {}, shownValue: () => "4 m" };
              done([MeshMap.prototype.labelOf.call(map, { serial: 102, name: "east tank" }),
                MeshMap.prototype.labelOf.call(map, { serial: 101 })]); });""")
        self.assertEqual(label, [{"text": "east tank: 4 m", "short": "4 m"}, {"text": "4 m", "short": None}])

    def test_only_what_lies_among_sensors_is_shaded(self):
        self.start_tanks(SQUARE, {1: 0, 2: 4000, 3: 0, 4: 0})
        self.browser.get(self.url)
        # Three sensors with something in their middle, and something beside them.
        shaded = lambda middle, beside: self.browser.execute_async_script("""
            const [middle, beside, done] = arguments;
            Promise.all(["model", "shading"].map((name) => import(`./${name}.js`)))
              .then(([{ readMesh }, { Shading }]) => {
                const point = (id, x, y, kind, neighbours, open) => ({ id, geometry: { coordinates: [x, y] },
                  properties: { kind, neighbours, open, in_mesh: true, serial: kind === "node" ? id : undefined } });
                const mesh = readMesh({ features: [point(0, 0, 0, "node", [1, 3, 2], [2]),
                  point(1, 10, 0, "node", [4, 2, 3, 0], [3]), point(2, 5, 8, "node", [0, 3, 1, 4], [3]),
                  point(3, 5, 3, middle, [2, 0, 1]), point(4, 15, 8, beside, [2, 1], [1])] });
                const readings = new Map([0, 1, 2].map((id) => [id, { value: id, isStale: false }]));
                done(new Shading(mesh, { name: "level" }, readings).shaded.length);
              });""", middle, beside)
        self.assertEqual(shaded("anchor", "node"), 3, "a fence makes no hole")
        self.assertEqual(shaded("anchor", "anchor"), 3, "nothing beyond")
        self.assertEqual(shaded("node", "node"), 3, "nor does a node that measures something else")

    def test_without_devices_there_is_nothing_to_choose(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
        self.browser.get(self.url)
        self.wait_for_text("#counts", r"Nodes\s*2")
        self.assertFalse(self.find("#measured").is_displayed())

    # The same pixels are 100 units, and 100 m where a unit is a metre: the page's own words for both.
    def test_lengths_are_in_metres_where_they_are_known(self):
        self.start_page(["0,1,join,0,0", "0,2,join,1000,0"])
        self.browser.get(self.url)
        texts = self.browser.execute_async_script("""
            const done = arguments[arguments.length - 1];
            import("./model.js").then(({ lengthText }) => done([
              lengthText(200), lengthText(200, 1), lengthText(20000, 0.01), lengthText(2500, 1),
              lengthText(50, 0.001), lengthText(500, 0.3048)]));""")
        self.assertEqual(texts, ["200 units", "200 m", "200 m", "2.5 km", "50 mm", "152 m"])
        wait_for("a scale", lambda: self.text("#scale").endswith(" units"))

    # Between the nodes of a feature values are linear along it, and corners without one are bare:
    # what the page works out is asked of its own modules.
    def test_values_between_nodes_are_linear_along_the_feature(self):
        self.start_tanks([(0, 0), (1000, 0), (500, 30), (480, -40)], {1: 0, 2: 1000, 3: 5000, 4: 5000},
                         "[[feature]]\nfrom = 101\nto = 102\n")
        self.wait_for_header(nodes=4, features=1)
        self.wait_for_levels({101: (0, False), 102: (1, False), 103: (5, False), 104: (5, False)})
        self.browser.get(self.url)
        ask = lambda: self.browser.execute_async_script("""
            const done = arguments[arguments.length - 1];
            (async () => {
              const { readMesh } = await import("./model.js");
              const { readReadings, valuesOn } = await import("./readings.js");
              const { Shading } = await import("./shading.js");
              const get = async (path) => (await fetch(path)).json();
              const mesh = readMesh(await get("mesh.json"));
              const readings = readReadings(await get("readings.json"));
              const values = valuesOn(mesh, readings.ofQuantity[0]);
              const shading = new Shading(mesh, readings.quantities[0], readings.ofQuantity[0]);
              done({ steiner: mesh.steiner.map((p) => [p.x, values.get(p.id)]),
                     shaded: shading.shaded.length });
            })();""")
        found = ask()
        self.assertGreater(len(found["steiner"]), 0)
        for x, value in found["steiner"]:
            self.assertAlmostEqual(value, x / 1000, 6)
        triangles = self.json("/status.json")["triangles"]
        self.assertEqual(found["shaded"], triangles)
        self.tanks.set({1: INVALID})
        self.wait_for_levels({101: (None, False), 102: (1, False), 103: (5, False), 104: (5, False)})
        found = ask()
        self.assertEqual([value for _, value in found["steiner"]], [None] * len(found["steiner"]))
        self.assertLess(found["shaded"], triangles)

    def test_a_thousand_nodes_by_day_and_by_night(self):
        self.vertices_max, self.interval = 2000, "5s"
        places = [(n * 7919 % 10007, n * n % 7993) for n in range(1, 1001)]
        groups = [places[at:at + 200] for at in range(0, 1000, 200)]
        tanks = [Tanks(self, group, f"tanks{at}", 1000 * (at + 1)) for at, group in enumerate(groups)]
        for group, places in zip(tanks, groups):
            group.set({unit: round(9000 * math.sin(x / 3000) * math.cos(y / 2500))
                       for unit, (x, y) in enumerate(places, start=1)})
        gateway = self.start_gateway([], self.HTTP + "".join(group.settings for group in tanks),
                                     head=PROFILE)
        self.url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        for name, width, height, colours in (("day", 1280, 800, "light"), ("night", 1280, 800, "dark"),
                                             ("narrow", 360, 760, "light")):
            self.size(width, height, colours)
            self.browser.get(self.url)
            self.wait_for_text("#counts", r"Nodes\s*1000")
            self.wait_for_text("#quantity", r"level")
            self.choose("level (m)")
            self.wait_for_text("#measured-count", r"^1000 nodes$")
            self.assertEqual(self.browser.execute_script(
                "return document.documentElement.scrollWidth"), width if width < 500 else 1280)
            self.screenshot(f"readings-{name}")
        self.watch()


if __name__ == "__main__":
    unittest.main(verbosity=2)
