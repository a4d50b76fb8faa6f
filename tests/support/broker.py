"""Mosquitto run for real, with the configurations that come with the gateway."""
import os
import pathlib
import re
import signal
import subprocess

from programs import PATIENCE_S, free_port, wait_for

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "firmware/examples"
SITE = "harbour"


class Broker:
    """A broker with one of the configurations in firmware/examples/mosquitto, in `folder`, and the
    lines `more`."""

    def __init__(self, case, example="etcm.conf", name="broker", port=None, more=(),
                 address="127.0.0.1"):
        self.case = case
        self.example = example
        self.more = more
        self.name = name
        self.port = port or free_port()
        self.address = address
        self.program = None
        (case.folder / "etcm.acl").write_text((EXAMPLES / "mosquitto/etcm.acl").read_text())
        self.start()

    def start(self):
        text = (EXAMPLES / "mosquitto" / self.example).read_text()
        text = text.replace("/etc/mosquitto", str(self.case.folder))
        text, count = re.subn(r"(?m)^listener \d+$", f"listener {self.port} {self.address}", text)
        self.case.assertEqual(count, 1)
        text += "".join(line + "\n" for line in self.more)
        # As root it would go on as another user, who cannot read this folder.
        text += f"user {'root' if os.geteuid() == 0 else 'mosquitto'}\n"
        path = self.case.folder / f"{self.name}.conf"
        path.write_text(text)
        self.program = self.case.start(self.name, ["mosquitto", "-v", "-c", path])
        self.program.wait_for_line("mosquitto version .* running")

    def stop(self):
        # Mosquitto forgets a signal that comes after its word that it runs and before its loop.
        def has_ended():
            self.program.process.send_signal(signal.SIGTERM)
            return self.program.process.poll() is not None

        wait_for(f"{self.name} to end", has_ended)
        self.program.stop()


def add_users(folder, users):
    """Passwords of the broker: {user: password}."""
    path = folder / "etcm.passwd"
    path.touch(mode=0o600)
    for user, password in users.items():
        done = subprocess.run(["mosquitto_passwd", "-b", path, user, password],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        assert done.returncode == 0, done.stderr
