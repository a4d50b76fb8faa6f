"""A throwaway Debian that systemd has booted: a container over a folder, which stays as it is."""
import os
import pathlib
import re
import shutil
import subprocess

from programs import PATIENCE_S, wait_for


class CannotBoot(Exception):
    """Containers do not start here; the text says why."""


GROUPS = pathlib.Path("/sys/fs/cgroup")


def control_group(name):
    """A new one, so that machines that run at the same time do not share theirs."""
    mounts = re.findall(r"^\S+ (\S+) cgroup2 ", pathlib.Path("/proc/self/mounts").read_text(), re.M)
    own = re.search(r"^0::/(.*)$", pathlib.Path("/proc/self/cgroup").read_text(), re.M)
    if not mounts or not own:
        raise CannotBoot("needs version 2 control groups")
    group = pathlib.Path(mounts[0], own[1], name)
    try:
        group.mkdir()
    except OSError as error:
        raise CannotBoot(f"makes no control group ({error})") from error
    return group


class Machine:
    """What it writes is in memory and ends with it. Its network has nothing in it but itself."""

    def __init__(self, root, shared):
        """Boots the system in the folder `root`; it sees `shared` at the same path."""
        if shutil.which("systemd-nspawn") is None:
            raise CannotBoot("needs systemd-nspawn, from the package systemd-container")
        self.group = control_group(pathlib.Path(shared).name)
        self.leader = None
        self.log = open(pathlib.Path(shared) / "boot.log", "w+")
        # DeviceAllow is a program that its systemd gives the kernel.
        self.process = subprocess.Popen(
            ["sh", "-c", f'echo $$ >{self.group}/cgroup.procs && exec "$@"', "sh",
             "systemd-nspawn", "--boot", f"--directory={root}", "--volatile=overlay",
             "--register=no", "--keep-unit", "--private-network", "--link-journal=no",
             "--settings=no", "--console=pipe", "--capability=CAP_BPF", "--system-call-filter=bpf",
             "--machine=etcm-test", f"--bind={shared}"],
            stdin=subprocess.DEVNULL, stdout=self.log, stderr=subprocess.STDOUT,
            env={**os.environ, "SYSTEMD_NSPAWN_UNIFIED_HIERARCHY": "1"})
        try:
            wait_for("systemd as process 1", self.find_leader)
            self.run("systemctl", "is-system-running", "--wait")
        except BaseException:
            self.stop()
            raise

    def find_leader(self):
        if self.process.poll() is not None:
            self.log.seek(0)
            raise CannotBoot(f"systemd-nspawn ends: {self.log.read().strip()}")
        children = pathlib.Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children")
        for self.leader in children.read_text().split():
            if subprocess.run(self.command("test", "-S", "/run/systemd/private"),
                              capture_output=True).returncode == 0:
                return True
        return False

    def command(self, *words):
        """What runs these words in it."""
        return ["nsenter", "-t", self.leader, "-a", *(str(word) for word in words)]

    def run(self, *words, code=0):
        """What a command in it prints; its exit status must be `code`."""
        done = subprocess.run(self.command(*words), capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=PATIENCE_S)
        if done.returncode != code:
            raise AssertionError(f"{words}: {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def stop(self):
        """At once: nothing in it is worth an orderly end."""
        # Its control group ends it whole, whatever it has become.
        (self.group / "cgroup.kill").write_text("1")
        self.process.wait()
        self.log.close()
        wait_for("the end of the machine",
                 lambda: "populated 0" in (self.group / "cgroup.events").read_text())
        # systemd-nspawn has made more of the same name where there are version 1 groups too.
        for top in GROUPS.rglob(self.group.name):
            for group in sorted([top, *(path for path in top.rglob("*") if path.is_dir())],
                                reverse=True):
                group.rmdir()
