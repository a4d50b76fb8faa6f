"""A virtual ARM board: Debian's kernel in QEMU, its digital lines and its serial port in our hands.

The PL061 of QEMU's `virt` machine is gpiochip0. The host drives its inputs and sees its outputs over
the qtest socket, while the guest runs as usual. The serial port is a 16550 on PCI, whose driver knows
nothing of RS-485, or the PL011, whose driver takes its settings from the device tree.
"""
import gzip
import json
import pathlib
import re
import shutil
import socket
import subprocess
import threading
import time

from programs import free_port

LINES = ["ALERT", "JOIN", "LED", "POWER_KEY", "WATCHDOG"]
MODULES = ["failover", "net_failover", "virtio", "virtio_ring", "virtio_pci_legacy_dev",
           "virtio_pci_modern_dev", "virtio_pci", "virtio_net"]
QEMU = ["qemu-system-arm", "-M", "virt,highmem=off", "-accel", "tcg", "-cpu", "cortex-a15",
        "-m", "256"]
INIT = """#!/bin/busybox sh
/bin/busybox --install -s /bin
mkdir -p /proc /sys /dev /tmp
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
for module in {modules}; do [ -f /modules/$module.ko ] && insmod /modules/$module.ko; done
ip link set lo up
ip addr add 10.0.2.15/24 dev eth0
ip link set eth0 up
etcm-gateway --config /site.toml &
gateway=$!
echo "board is up"
while read -r command; do eval "$command"; done
"""


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise RuntimeError(f"{command[0]} failed: {done.stderr}")
    return done.stdout


def libraries(program, folder):
    """The shared libraries a program needs, found in a sysroot."""
    found, waiting = {}, [program]
    while waiting:
        for name in re.findall(r"\(NEEDED\)\s+Shared library: \[(.*)\]",
                               run("readelf", "-d", waiting.pop())):
            if name not in found:
                found[name] = next(path for path in (folder / "usr/lib").rglob(name))
                waiting.append(found[name])
    return found


def make_initrd(target, gateway, config, sysroot, kernel, tools):
    """The file system: busybox, the gateway with what it needs, the drivers of the network."""
    root = target.with_suffix(".root")
    for folder in ("bin", "lib", "modules"):
        (root / folder).mkdir(parents=True)
    shutil.copy(next(kernel.rglob("bin/busybox")), root / "bin")
    for program in (gateway, *tools):
        shutil.copy(program, root / "bin")
    for name, path in libraries(gateway, sysroot).items():
        shutil.copy(path, root / "lib" / name)
    shutil.copy(next((sysroot / "usr/lib").rglob("ld-linux-armhf.so.3")), root / "lib")
    for name in MODULES:
        for path in (kernel / "usr/lib/modules").rglob(f"{name}.ko"):
            shutil.copy(path, root / "modules")
    (root / "site.toml").write_text(config)
    (root / "init").write_text(INIT.format(modules=" ".join(MODULES)))
    (root / "init").chmod(0o755)
    names = "\n".join(str(path.relative_to(root)) for path in sorted(root.rglob("*")))
    packed = subprocess.run(["cpio", "-o", "-H", "newc", "--quiet"], cwd=root, input=names.encode(),
                            capture_output=True, check=True).stdout
    target.write_bytes(gzip.compress(packed, 1))


def make_device_tree(target, rs485):
    """QEMU's own, with names for the lines, and settings of RS-485 for the PL011."""
    run(*QEMU[:2], QEMU[2] + f",dumpdtb={target}", *QEMU[3:], "-nographic", "-nic", "none")
    run("fdtput", "-t", "s", target, "/pl061@9030000", "gpio-line-names", *LINES)
    for name, cells in rs485.items():
        run("fdtput", "-t", "u", target, "/pl011@9000000", name, *cells)


class Board:
    def __init__(self, folder, gateway, config, sysroot, kernel, guest_port, tools=(), rs485=None):
        """`rs485`: properties of the PL011, which is the serial port then, /dev/ttyAMA0, and the
        console is /dev/ttyS0; /dev/ttyS1 leads nowhere. Else the serial port is /dev/ttyS0."""
        make_initrd(folder / "initrd", gateway, config, sysroot, kernel, tools)
        make_device_tree(folder / "board.dtb", rs485 or {})
        self.port = free_port()
        self.serial_path = folder / "serial"
        listener = socket.socket(socket.AF_UNIX)
        listener.bind(str(folder / "qtest"))
        listener.listen()
        self.levels = {}       # by line
        self.edges = []        # (time, line, level)
        self.replies = []
        self.output = ""
        self.changed = threading.Condition()
        if rs485 is None:
            console = "ttyAMA0"
            serial = ["-serial", "stdio", "-device", "pci-serial,chardev=line"]
        else:
            console = "ttyS0"
            serial = ["-serial", "chardev:line", "-chardev", "stdio,id=console,signal=off",
                      "-device", "pci-serial,chardev=console", "-chardev", "null,id=nobody",
                      "-device", "pci-serial,chardev=nobody"]
        self.process = subprocess.Popen(
            [*QEMU, "-nographic", "-monitor", "none", *serial, "-no-reboot",
             "-kernel", next((kernel / "boot").glob("vmlinuz-*")), "-initrd", folder / "initrd",
             "-dtb", folder / "board.dtb",
             "-append", f"console={console} quiet loglevel=0 panic=-1",
             "-qtest", f"unix:{folder / 'qtest'}", "-qtest-log", "/dev/null",
             "-qmp", f"unix:{folder / 'qmp'},server=on,wait=off",
             "-chardev", f"socket,id=line,path={self.serial_path},server=on,wait=off",
             "-netdev", f"user,id=net,restrict=on,hostfwd=tcp:127.0.0.1:{self.port}-:{guest_port}",
             "-device", "virtio-net-pci,netdev=net,romfile="],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        listener.settimeout(30)
        self.qtest = listener.accept()[0]
        listener.close()
        self.threads = [threading.Thread(target=self.follow_console),
                        threading.Thread(target=self.follow_lines)]
        for thread in self.threads:
            thread.start()
        self.chip = self.find_chip(folder / "qmp")
        self.ask(f"irq_intercept_out {self.chip}")

    def find_chip(self, path):
        with socket.socket(socket.AF_UNIX) as monitor:
            monitor.connect(str(path))
            stream = monitor.makefile("rw")
            stream.readline()
            for command in ({"execute": "qmp_capabilities"},
                            {"execute": "qom-list", "arguments": {"path": "/machine/unattached"}}):
                stream.write(json.dumps(command) + "\n")
                stream.flush()
                answer = {}
                while "return" not in answer:
                    answer = json.loads(stream.readline())
            return next(f"/machine/unattached/{found['name']}" for found in answer["return"]
                        if found["type"] == "child<pl061>")

    def follow_console(self):
        while data := self.process.stdout.read1():
            with self.changed:
                self.output += data.decode(errors="replace")
                self.changed.notify_all()

    def follow_lines(self):
        for text in self.qtest.makefile("r"):
            with self.changed:
                if match := re.match(r"IRQ (raise|lower) (\d+)", text):
                    line, level = int(match[2]), match[1] == "raise"
                    self.levels[line] = level
                    self.edges.append((time.monotonic(), line, level))
                else:
                    self.replies.append(text)
                self.changed.notify_all()

    def wait_for(self, what, condition, patience_s):
        with self.changed:
            if not self.changed.wait_for(condition, patience_s):
                raise AssertionError(f"waited {patience_s} s for {what}; the board says:\n"
                                     + self.output)

    def ask(self, command):
        count = len(self.replies)
        self.qtest.sendall(f"{command}\n".encode())
        self.wait_for(f"an answer to {command}", lambda: len(self.replies) > count, 30)
        if not self.replies[-1].startswith("OK"):
            raise RuntimeError(f"qtest: {command}: {self.replies[-1]}")

    def drive(self, name, level):
        self.ask(f"set_irq_in {self.chip} unnamed-gpio-in {LINES.index(name)} {int(level)}")

    def wait_for_output(self, pattern, patience_s=60):
        self.wait_for(f"'{pattern}'", lambda: re.search(pattern, self.output), patience_s)

    def wait_for_news(self, command, pattern):
        """Tells the shell of the board a command, and waits for what comes of it."""
        with self.changed:
            begin = len(self.output)
        self.tell(command)
        self.wait_for(f"'{pattern}'", lambda: re.search(pattern, self.output[begin:]), 60)

    def tell(self, command):
        """A line for the shell of the board."""
        self.process.stdin.write(command.encode() + b"\n")
        self.process.stdin.flush()

    def rises(self, name, since):
        line = LINES.index(name)
        with self.changed:
            return [at for at, found, level in self.edges if found == line and level and at > since]

    def stop(self):
        self.process.kill()
        self.process.wait()
        for thread in self.threads:
            thread.join()
        self.qtest.close()
        self.process.stdin.close()
        self.process.stdout.close()
