"""A gateway that the system gives few descriptors, from none on, each number of them: it ends and says
what to raise, or goes on with what it could have and says what it goes without. Nothing that was kept
is lost.

The programs' folder is in ETCM_BIN.
"""
import pathlib
import resource
import shutil
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE))
sys.path.insert(0, str(HERE.parent / "support"))
from gateway_test import PROGRAMS, GatewayCase
from programs import PATIENCE_S, wait_for

STATE = '[state]\nfolder = "state"\ninterval = "1s"\n[http]\nlisten = "127.0.0.1:0"\n'
# Below that the shared libraries are not found, which is not the program's to say.
LEAST = 4
# Plenty for one bus, its server, page and folders.
MOST = 32


class FewDescriptors(GatewayCase):
    def test_each_number_of_them(self):
        gateway = self.start_gateway(
            self.start_nodes(["0,1,join,0,0", "0,2,join,1000,-5"]), STATE)
        self.wait_for_header(nodes=2)
        self.assertEqual(gateway.stop(), 0)
        kept = (self.folder / "state" / "state").read_bytes()
        shutil.move(self.folder / "state", self.folder / "sound")
        ended, went_on = [], []
        for count in range(LEAST, MOST + 1):
            with self.subTest(count=count):
                shutil.rmtree(self.folder / "state", ignore_errors=True)
                shutil.copytree(self.folder / "sound", self.folder / "state")
                said = self.run_with(count, ended, went_on)
                for line in said.splitlines():
                    if "Too many open files" in line:
                        self.assertRegex(line, "; raise LimitNOFILE of the service", said)
                if "restored the mesh" not in said:
                    files = (self.folder / "state").glob("state*")
                    self.assertIn(kept, [file.read_bytes() for file in files], said)
        self.assertTrue(ended and went_on, (ended, went_on))
        self.assertLess(max(ended), min(went_on), "with more it does not do less")

    def run_with(self, count, ended, went_on):
        """What it says, until it ends or has asked its nodes, or goes on without."""
        def limit():
            resource.setrlimit(resource.RLIMIT_NOFILE, (count, count))
        log = self.folder / "few.log"
        with open(log, "w") as out:
            gateway = subprocess.Popen(
                [PROGRAMS / "etcm-gateway", "--config", "site.toml"], cwd=self.folder, stdout=out,
                stderr=subprocess.STDOUT, preexec_fn=limit)
        try:
            wait_for("an end, or a first bus", lambda: gateway.poll() is not None or any(
                words in log.read_text() for words in ("connected to", "trying again")))
            if gateway.poll() is None:
                went_on.append(count)
                gateway.terminate()
                self.assertEqual(gateway.wait(PATIENCE_S), 0, log.read_text())
            else:
                ended.append(count)
                self.assertEqual(gateway.returncode, 1, log.read_text())
                self.assertRegex(log.read_text().splitlines()[-1],
                                 "error: cannot start: .*Too many open files; raise LimitNOFILE")
        finally:
            gateway.kill()
            gateway.wait()
        return log.read_text()


if __name__ == "__main__":
    unittest.main()
