"""The alert rules and the dashboard that come with the package, by a real Prometheus that watches a
real gateway.

The programs' folder is in ETCM_BIN.
"""
import json
import pathlib
import re
import subprocess
import sys
import unittest
import urllib.parse
import urllib.request

HERE = pathlib.Path(__file__).parent
EXAMPLES = HERE.parent.parent / "firmware/examples"
RULES = EXAMPLES / "prometheus/etcm-alerts.yml"
DASHBOARD = EXAMPLES / "grafana/etcm-gateways.json"
sys.path.insert(0, str(HERE))
sys.path.insert(0, str(HERE.parent / "support"))
from browser import PageCase
from gateway_test import SOON
from measuring import PROFILE, Tanks
from programs import free_port, wait_for

# Of each alert what makes it fire, and of some what does not. A minute is a sample. The labels are those
# that a gateway gives, which is compared below.
UNIT_TESTS = """
rule_files: [rules.yml]
evaluation_interval: 1m
tests:
  - interval: 1m
    input_series:
      - {series: 'up{job="etcm",instance="a"}', values: '0x30'}
      - {series: 'etcm_alarms{severity="critical",instance="a"}', values: '0x5 1x25'}
      - {series: 'etcm_alarms{severity="major",instance="a"}', values: '2x30'}
      - {series: 'etcm_bus_silent{bus="yard",instance="a"}', values: '0x5 1x25'}
      - {series: 'etcm_node_missing_seconds{serial="7",instance="a"}', values: '60+60x30'}
      - {series: 'etcm_unit_requests_total{bus="yard",unit="3",instance="a"}', values: '0+60x40'}
      - {series: 'etcm_unit_errors_total{bus="yard",unit="3",kind="timeout",instance="a"}', values: '0+30x40'}
      - {series: 'etcm_unit_answer_seconds_count{bus="yard",unit="3",instance="a"}', values: '0+30x40'}
      - {series: 'etcm_unit_requests_total{bus="yard",unit="4",instance="a"}', values: '0+60x40'}
      - {series: 'etcm_unit_errors_total{bus="yard",unit="4",kind="timeout",instance="a"}', values: '0+60x40'}
      - {series: 'etcm_unit_answer_seconds_count{bus="yard",unit="4",instance="a"}', values: '0x40'}
      - {series: 'etcm_bus_utilisation_ratio{bus="yard",instance="a"}', values: '0.95x30'}
      - {series: 'etcm_bus_utilisation_ratio{bus="mill",instance="a"}', values: '0.85x30'}
      - {series: 'etcm_disk_trouble{section="state",instance="a"}', values: '1x30'}
      - {series: 'etcm_disk_trouble{section="files",instance="a"}', values: '0x30'}
      - {series: 'etcm_configuration_refused{instance="a"}', values: '1x30'}
      - {series: 'etcm_configuration_refused{instance="b"}', values: '0x30'}
      - {series: 'etcm_reading_disagrees{name="level",unit="m",serial="7",instance="a"}', values: '1x30'}
      - {series: 'etcm_reading_disagrees{name="level",unit="m",serial="8",instance="a"}', values: '0x30'}
      - {series: 'etcm_fleet_connected{instance="a"}', values: '1x30'}
      - {series: 'etcm_fleet_agreeing{instance="a"}', values: '2x30'}
      - {series: 'etcm_fleet_members{state="here",instance="a"}', values: '2x30'}
      - {series: 'etcm_fleet_members{state="gone",instance="a"}', values: '1x30'}
      - {series: 'etcm_fleet_connected{instance="b"}', values: '0x30'}
      - {series: 'etcm_fleet_agreeing{instance="b"}', values: '3x30'}
      - {series: 'etcm_fleet_members{state="here",instance="b"}', values: '3x30'}
      - {series: 'etcm_fleet_members{state="gone",instance="b"}', values: '0x30'}
    promql_expr_test:
      - expr: count by (alertname) (ALERTS{alertstate="firing"})
        eval_time: 4m
        exp_samples:
          - {labels: '{alertname="EtcmGatewayDown"}', value: 1}
          - {labels: '{alertname="EtcmFleetApart"}', value: 1}
      - expr: count by (alertname, unit) (ALERTS{alertstate="firing"})
        eval_time: 30m
        exp_samples:
          - {labels: '{alertname="EtcmGatewayDown"}', value: 1}
          - {labels: '{alertname="EtcmAlarmCritical"}', value: 1}
          - {labels: '{alertname="EtcmAlarmMajor"}', value: 1}
          - {labels: '{alertname="EtcmBusSilent"}', value: 1}
          - {labels: '{alertname="EtcmNodeMissing"}', value: 1}
          - {labels: '{alertname="EtcmUnitErrors", unit="3"}', value: 1}
          - {labels: '{alertname="EtcmBusBusy"}', value: 1}
          - {labels: '{alertname="EtcmDiskTrouble"}', value: 1}
          - {labels: '{alertname="EtcmConfigurationRefused"}', value: 1}
          - {labels: '{alertname="EtcmFleetApart"}', value: 1}
          - {labels: '{alertname="EtcmFleetDisagrees"}', value: 1}
          - {labels: '{alertname="EtcmSensorDisagrees", unit="m"}', value: 1}
      - expr: count by (alertname, instance) (ALERTS{alertstate="firing", alertname=~"EtcmFleet.*"})
        eval_time: 30m
        exp_samples:
          - {labels: '{alertname="EtcmFleetDisagrees", instance="a"}', value: 1}
          - {labels: '{alertname="EtcmFleetApart", instance="b"}', value: 1}
  - interval: 1m
    input_series:
      - {series: 'etcm_alarms_unacknowledged{instance="a"}', values: '0x60 2x540'}
    promql_expr_test:
      - expr: count by (alertname) (ALERTS{alertstate="firing"})
        eval_time: 8h
        exp_samples: []
      - expr: count by (alertname) (ALERTS{alertstate="firing"})
        eval_time: 10h
        exp_samples:
          - {labels: '{alertname="EtcmAlarmUnacknowledged"}', value: 1}
"""


def series_of(text):
    """Names of metrics, each with the sets of labels it comes with; without those of Prometheus itself."""
    found = {}
    for name, labels in re.findall(r"(?m)(?:^|series: ')(\w+)(?:\{(.*?)\})?(?=[ '])", text):
        keys = set(re.findall(r'(\w+)="', labels)) - {"instance", "job"}
        found.setdefault(name, set()).add(frozenset(keys))
    return found


def tested_series():
    return series_of("".join(line + "\n" for line in UNIT_TESTS.splitlines() if "series: '" in line))


class WatchedFromOutside(PageCase):
    def test_the_rules_are_sound_and_each_fires_for_what_it_is_for(self):
        subprocess.run(["promtool", "check", "rules", RULES], check=True, capture_output=True)
        (self.folder / "rules.yml").write_text(RULES.read_text())
        (self.folder / "tests.yml").write_text(UNIT_TESTS)
        done = subprocess.run(["promtool", "test", "rules", "tests.yml"], cwd=self.folder,
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_each_alert_and_each_series_that_it_asks_for_is_tested(self):
        rules = RULES.read_text()
        alerts = re.findall(r"(?m)^ +- alert: (\w+)$", rules)
        self.assertEqual(len(alerts), rules.count("expr:"))
        self.assertEqual(set(re.findall(r'alertname="(\w+)"', UNIT_TESTS)), set(alerts))
        asked = "".join(re.findall(r"(?ms)^ +expr: (.*?)^ +(?:for|labels):", rules))
        self.assertEqual(set(re.findall(r"etcm_\w+", asked)), set(tested_series()) - {"up"})

    def ask(self, expression):
        """The samples that a real Prometheus answers."""
        url = f"{self.prometheus}/api/v1/query?" + urllib.parse.urlencode({"query": expression})
        with urllib.request.urlopen(url, timeout=40) as answer:
            return json.load(answer)["data"]["result"]

    def start_prometheus(self):
        (self.folder / "prometheus.yml").write_text(
            "global: {scrape_interval: 1s, evaluation_interval: 1s}\n"
            f"rule_files: ['{RULES}']\n"
            "scrape_configs:\n"
            "  - job_name: etcm\n"
            f"    static_configs: [{{targets: ['{self.url.removeprefix('http://').rstrip('/')}']}}]\n")
        self.prometheus = f"http://127.0.0.1:{free_port()}"
        self.start("prometheus", ["prometheus", "--config.file=prometheus.yml",
                                  "--storage.tsdb.path=data",
                                  f"--web.listen-address={self.prometheus.removeprefix('http://')}"])

        def has_scraped():
            try:
                return self.ask("etcm_nodes")
            except OSError:
                return None
        wait_for("a first sample", has_scraped)

    def start_whole_gateway(self):
        """It has nodes, one of which falls silent, devices that measure, and a fleet whose broker is away."""
        tanks = Tanks(self, [(2000, 0), (2000, 500)])
        tanks.set({1: 1500, 2: 1700})
        buses = self.start_nodes(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,500,500",
                                  "4000,3,silent,,"])
        fleet = f'[mqtt]\nbroker = "127.0.0.1:{free_port()}"\nsite = "yard"\nname = "north"\n'
        gateway = self.start_gateway(buses, self.HTTP + fleet + tanks.settings, head=PROFILE, **SOON)
        self.url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        gateway.wait_for_line(r"node 3 is missing")
        return gateway

    def test_a_gateway_gives_each_series_of_the_alerts_with_the_labels_they_are_tested_with(self):
        self.start_whole_gateway()
        wanted = tested_series()
        wanted.pop("up")
        wait_for("readings", lambda: b"\netcm_reading_disagrees{" in self.get("/metrics"))
        given = series_of(self.get("/metrics").decode())
        self.assertEqual({name: given.get(name) for name in wanted}, wanted)

    def test_a_prometheus_sees_who_is_missing_and_the_dashboard_has_data(self):
        self.start_whole_gateway()
        self.start_prometheus()
        wait_for("the alert", lambda: self.ask('ALERTS{alertname="EtcmAlarmMajor"}'))
        [missing] = self.ask("etcm_node_missing_seconds")
        self.assertEqual(missing["metric"]["serial"], "3")
        panels = json.loads(DASHBOARD.read_text())["panels"]
        self.assertGreater(len(panels), 10)
        for panel in panels:
            for target in panel["targets"]:
                # Grafana puts in what is chosen.
                expression = target["expr"].replace("$instance", ".*")
                with self.subTest(panel["title"], expression=expression):
                    samples = wait_for(expression, lambda: self.ask(expression))
                    legends = [re.sub(r"{{(\w+)}}", lambda label: sample["metric"][label.group(1)],
                                      target["legendFormat"]) for sample in samples]
                    self.assertEqual(len(set(legends)), len(legends), legends)


if __name__ == "__main__":
    unittest.main(verbosity=2)
