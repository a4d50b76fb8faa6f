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
from programs import free_port, wait_for

# What a gateway without a fleet and without devices that measure has no samples of.
ELSEWHERE = ("etcm_fleet", "etcm_reading")

# Each rule, by what makes it fire. A minute is a sample.
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
      - {series: 'etcm_fleet_agreeing{instance="a"}', values: '2x30'}
      - {series: 'etcm_fleet_members{instance="a"}', values: '3x30'}
      - {series: 'etcm_fleet_agreeing{instance="b"}', values: '3x30'}
      - {series: 'etcm_fleet_members{instance="b"}', values: '3x30'}
    promql_expr_test:
      - expr: count by (alertname) (ALERTS{alertstate="firing"})
        eval_time: 4m
        exp_samples:
          - {labels: '{alertname="EtcmGatewayDown"}', value: 1}
      - expr: count by (alertname, unit) (ALERTS{alertstate="firing"})
        eval_time: 30m
        exp_samples:
          - {labels: '{alertname="EtcmGatewayDown"}', value: 1}
          - {labels: '{alertname="EtcmAlarmCritical"}', value: 1}
          - {labels: '{alertname="EtcmAlarmMajor"}', value: 1}
          - {labels: '{alertname="EtcmBusSilent"}', value: 1}
          - {labels: '{alertname="EtcmNodeMissing"}', value: 1}
          - {labels: '{alertname="EtcmUnitErrors", unit="3"}', value: 1}
          - {labels: '{alertname="EtcmFleetDisagrees"}', value: 1}
"""


class WatchedFromOutside(PageCase):
    def test_the_rules_are_sound_and_each_fires_for_what_it_is_for(self):
        subprocess.run(["promtool", "check", "rules", RULES], check=True, capture_output=True)
        (self.folder / "rules.yml").write_text(RULES.read_text())
        (self.folder / "tests.yml").write_text(UNIT_TESTS)
        done = subprocess.run(["promtool", "test", "rules", "tests.yml"], cwd=self.folder,
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

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

    def test_a_prometheus_sees_who_is_missing_and_the_dashboard_has_data(self):
        gateway = self.start_page(["0,1,join,0,0", "0,2,join,1000,0", "0,3,join,500,500",
                                   "4000,3,silent,,"], **SOON)
        self.start_prometheus()
        gateway.wait_for_line(r"node 3 is missing")
        wait_for("the alert", lambda: self.ask('ALERTS{alertname="EtcmAlarmMajor"}'))
        [missing] = self.ask("etcm_node_missing_seconds")
        self.assertEqual(missing["metric"]["serial"], "3")
        panels = json.loads(DASHBOARD.read_text())["panels"]
        self.assertGreater(len(panels), 10)
        for panel in panels:
            for target in panel["targets"]:
                # Grafana puts in what is chosen.
                expression = target["expr"].replace("$instance", ".*")
                if any(name in expression for name in ELSEWHERE):
                    self.ask(expression)
                    continue
                with self.subTest(panel["title"], expression=expression):
                    samples = wait_for(expression, lambda: self.ask(expression))
                    for label in re.findall(r"{{(\w+)}}", target["legendFormat"]):
                        self.assertIn(label, samples[0]["metric"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
