"""The Debian packages of the build in ETCM_BUILD, made by ETCM_CPACK: their content and their life in
a scratch system."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.request

from programs import PATIENCE_S, ProgramCase

BUILD = pathlib.Path(os.environ["ETCM_BUILD"])
SKIPPED = 77
PROGRAMS = ["etcm", "etcm-bus", "etcm-gateway", "etcm-nodes"]


def run(*command, code=0):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True,
                          timeout=PATIENCE_S)
    if done.returncode != code:
        raise AssertionError(f"{command}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def setUpModule():
    global MADE, GATEWAY, DEVELOPMENT
    MADE = tempfile.TemporaryDirectory(prefix="etcm_packages_")
    unittest.addModuleCleanup(MADE.cleanup)
    run(os.environ["ETCM_CPACK"], "--config", BUILD / "CPackConfig.cmake", "-B", MADE.name)
    folder = pathlib.Path(MADE.name)
    GATEWAY, = folder.glob("etcm-gateway_*.deb")
    DEVELOPMENT, = folder.glob("libetcm-dev_*.deb")


def with_version(folder, version):
    """The same package of another version, whose settings have other words in them."""
    parts = folder / f"parts_{version}"
    run("dpkg-deb", "-R", GATEWAY, parts)
    control = parts / "DEBIAN/control"
    control.write_text(re.sub(r"(?m)^Version: .*", f"Version: {version}", control.read_text()))
    settings = parts / "etc/etcm/gateway.toml"
    settings.write_text("# As it is in another version.\n" + settings.read_text())
    package = folder / f"{version}.deb"
    run("dpkg-deb", "--root-owner-group", "-b", parts, package)
    return package


def files_under(root):
    return sorted(str(path.relative_to(root)) for path in root.rglob("*")
                  if path.is_symlink() or path.is_file())


class Content(ProgramCase):
    def unpacked(self, package):
        root = self.folder / package.name
        run("dpkg-deb", "-x", package, root)
        return root

    def test_projects_build_with_what_developers_install(self):
        root = self.unpacked(DEVELOPMENT)
        description, = root.rglob("etcm.pc")
        environment = {**os.environ, "PKG_CONFIG_PATH": str(description.parent)}
        for name in ("outside", "outside_c"):
            source = pathlib.Path(__file__).parents[1] / "install" / name
            build = self.folder / name
            for command in (["-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={root}/usr"],
                            ["--build", build]):
                done = subprocess.run([os.environ["ETCM_CMAKE"], *map(str, command)],
                                      capture_output=True, text=True, env=environment,
                                      timeout=PATIENCE_S)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            suffix = name.removeprefix("outside")
            for program in (f"example{suffix}", f"example{suffix}_pkg_config"):
                self.assertEqual(run(build / program), "ok: 4 triangles, 1 Steiner vertices\n")

    def test_everything_is_where_debian_wants_it(self):
        found = files_under(self.unpacked(GATEWAY))
        for path in [*(f"usr/bin/{name}" for name in PROGRAMS), "etc/etcm/gateway.toml",
                     "usr/lib/systemd/system/etcm-gateway.service",
                     "usr/share/doc/etcm-gateway/copyright",
                     "usr/share/doc/etcm-gateway/changelog.gz", "usr/share/man/man1/etcm.1.gz",
                     "usr/share/bash-completion/completions/etcm-bus",
                     "usr/share/man/man1/etcm-bus.1.gz", "usr/share/man/man1/etcm-nodes.1.gz",
                     "usr/share/man/man8/etcm-gateway.8.gz",
                     "usr/share/man/man5/gateway.toml.5.gz",
                     "usr/share/doc/etcm-gateway/guide/README.md",
                     "usr/share/doc/etcm-gateway/guide/devices.png",
                     "usr/share/doc/etcm-gateway/guide/page.png",
                     "usr/share/doc/etcm-gateway/fleet/schema/alarms.json",
                     "usr/share/doc/etcm-gateway/fleet/schema/node.json",
                     "usr/share/etcm/examples/devices/gateway.toml",
                     "usr/share/etcm/examples/mosquitto/make-fleet",
                     "usr/share/etcm/examples/mosquitto/install-broker.sh",
                     "usr/share/etcm/examples/mosquitto/install-gateway.sh",
                     "usr/share/etcm/profiles/ebyte-e108.toml",
                     "usr/share/etcm/profiles/victron-gx.toml"]:
            self.assertIn(path, found)
        self.assertEqual([path for path in found if path.endswith((".h", ".a", ".cmake"))], [])
        development = files_under(self.unpacked(DEVELOPMENT))
        self.assertIn("usr/include/etcm/mesh.h", development)
        for document in ("docs/cost.md", "examples/cluster_head.c", "CHANGELOG.md"):
            self.assertIn(f"usr/share/doc/libetcm-dev/{document}", development)
        for file in ("etcm.cpp", "etcm.hpp", "etcm.h", "README.md"):
            self.assertIn(f"usr/share/etcm/drop-in/{file}", development)
        if shutil.which("doxygen"):
            self.assertIn("usr/share/doc/libetcm-dev/html/index.html", development)
        self.assertEqual([path for path in development if "/bin/" in path or path[:4] == "etc/"], [])

    def test_the_gateway_serves_the_guide(self):
        settings = self.folder / "gateway.toml"
        settings.write_text('[mesh]\nvertices_max = 100\n[server]\nlisten = "127.0.0.1:0"\n'
                            '[http]\nlisten = "127.0.0.1:0"\n')
        root = self.unpacked(GATEWAY)
        gateway = self.start("gateway", [root / "usr/bin/etcm-gateway", "--config", settings])
        url = gateway.wait_for_line(r"status page on (http://\S+)").group(1)
        guide = root / "usr/share/doc/etcm-gateway/guide"
        for path in ("", *(f"/{page.stem}.html" for page in guide.glob("*.md")),
                     *(f"/{picture.name}" for picture in guide.glob("*.png"))):
            with urllib.request.urlopen(f"{url}/guide{path}", timeout=PATIENCE_S) as answer:
                self.assertTrue(answer.read(), path)
        self.assertEqual(gateway.stop(), 0, gateway.log())

    def test_it_depends_on_what_its_programs_link(self):
        depends = run("dpkg-deb", "--field", GATEWAY, "Depends")
        names = re.findall(r"([a-z0-9.+-]+)(?: \([^)]*\))?(?:, |$)", depends.strip())
        for name in names:
            self.assertIn("install ok", run("dpkg-query", "-W", "-f", "${Status}", name))
        for library in ("libc6", "libmodbus5", "libmosquitto1", "libssl3", "libstdc++6"):
            self.assertIn(library, names)
        called = run("nm", "--dynamic", "--undefined-only",
                     self.unpacked(GATEWAY) / "usr/bin/etcm-gateway")
        for function in ("modbus_connect", "modbus_reply"):
            self.assertIn(function, called)

    def test_the_service_is_shut_in(self):
        unit = self.unpacked(GATEWAY) / "usr/lib/systemd/system/etcm-gateway.service"
        self.assertIn("ExecStart=/usr/bin/etcm-gateway --config /etc/etcm/gateway.toml",
                      unit.read_text())
        if shutil.which("systemd-analyze") is None:
            self.skipTest("systemd is not installed")
        # Exposure at most 1.5, in tenths.
        run("systemd-analyze", "security", "--offline=true", "--no-pager", "--threshold=15", unit)

    def test_systemd_understands_every_line_of_the_service(self):
        if shutil.which("systemd-analyze") is None:
            self.skipTest("systemd is not installed")
        root = self.unpacked(GATEWAY)
        unit = root / "usr/lib/systemd/system/etcm-gateway.service"
        # It looks whether the program is there.
        unit.write_text(unit.read_text().replace("/usr/bin/", f"{root}/usr/bin/"))
        done = subprocess.run(["systemd-analyze", "verify", "--man=no", "--recursive-errors=no",
                               unit], capture_output=True, text=True, timeout=PATIENCE_S)
        about_ours = [line for line in done.stderr.splitlines() if "etcm" in line]
        self.assertEqual((done.returncode, about_ours), (0, []), done.stderr)

    def test_manual_pages_are_well_formed(self):
        if shutil.which("mandoc") is None:
            self.skipTest("mandoc is not installed")
        pages = list((self.unpacked(GATEWAY) / "usr/share/man").rglob("*.gz"))
        self.assertGreaterEqual(len(pages), 5)
        for page in pages:
            plain = self.folder / page.stem
            plain.write_bytes(subprocess.run(["gzip", "-dc", page], capture_output=True,
                                             check=True).stdout)
            self.assertEqual(run("mandoc", "-T", "lint", "-W", "warning", plain), "")

    def test_the_guide_links_to_nothing_that_is_not_in_the_package(self):
        guide = self.unpacked(GATEWAY) / "usr/share/doc/etcm-gateway/guide"
        for page in guide.glob("*.md"):
            text = re.sub(r"```.*?```", "", page.read_text(), flags=re.S)
            for target in re.findall(r"\]\(([^)#\s]+)", text):
                self.assertTrue("://" in target or (guide / target).is_file(),
                                f"{page.name}: {target}")

    def test_the_manual_names_every_option(self):
        root = self.unpacked(GATEWAY)
        for name, section in (("etcm-bus", 1), ("etcm-nodes", 1), ("etcm-gateway", 8), ("etcm", 1)):
            page = subprocess.run(["gzip", "-dc", root / f"usr/share/man/man{section}" /
                                   f"{name}.{section}.gz"], capture_output=True, text=True,
                                  check=True).stdout
            # The requests of manual pages, taken out.
            text = re.sub(r"\\-", "-", re.sub(r"^\.\w+ ", "", page, flags=re.M))
            help_texts = [run(root / "usr/bin" / name, "--help")]
            for command in re.findall(r"^  (\w+) {3,}", help_texts[0].split("Subcommands:")[-1],
                                      re.M) if "Subcommands:" in help_texts[0] else []:
                help_texts.append(run(root / "usr/bin" / name, command, "--help"))
            for option in set(re.findall(r"--([a-z][a-z-]+)", "".join(help_texts))) - {"help"}:
                self.assertIn(option, text, f"{name}.{section}: --{option}")
            # "  -0,-q,-B  as mbpoll has them"
            heads = re.findall(r"(?m)^ +(-[^ ]*)", "".join(help_texts))
            letters = set(re.findall(r"(?:^|,)-(\w)\b", "\n".join(heads), re.M)) - {"h"}
            named = set(re.findall(r"(?m)\bFl (\w)(?= |$)", page))
            self.assertEqual(letters - named, set(), f"{name}.{section}")


class SystemCalls(ProgramCase):
    """A call that the service must not make ends in an error only where systemd is; here it shows."""

    def groups(self):
        text = run("systemd-analyze", "syscall-filter")
        found = {}
        for line in text.splitlines():
            line = re.sub(r"\x1b\[[0-9;]*m", "", line).split("#")[0].rstrip()
            if line.startswith("@"):
                members = found.setdefault(line, [])
            elif line.strip():
                members.append(line.strip())
        return found

    def expanded(self, name, groups):
        if not name.startswith("@"):
            return {name}
        return set().union(*(self.expanded(member, groups) for member in groups[name]))

    def test_the_service_may_make_every_call_that_the_gateway_makes(self):
        if shutil.which("systemd-analyze") is None or shutil.which("strace") is None:
            self.skipTest("systemd or strace is not installed")
        root = self.folder / "root"
        run("dpkg-deb", "-x", GATEWAY, root)
        unit = (root / "usr/lib/systemd/system/etcm-gateway.service").read_text()
        groups = self.groups()
        allowed = self.expanded("@default", groups)
        for line in re.findall(r"^SystemCallFilter=(.*)$", unit, re.M):
            for name in line.lstrip("~").split():
                calls = self.expanded(name, groups)
                allowed = allowed - calls if line.startswith("~") else allowed | calls

        (self.folder / "nodes.csv").write_text("time_ms,serial,event,x,y\n0,1,join,0,0\n"
                                               "0,2,join,90,0\n0,3,join,0,90\n")
        line = self.folder / "line"
        nodes = self.start("nodes", [root / "usr/bin/etcm-nodes", "--rtu", line, "--nodes",
                                     "nodes.csv"])
        nodes.wait_for_line("ready:")
        settings = (root / "etc/etcm/gateway.toml").read_text()
        settings = settings.replace("/var/lib/etcm", str(self.folder))
        settings = re.sub(r'(?m)^(listen = "127.0.0.1):\d+', r"\1:0", settings)
        settings += f'[[bus]]\nrtu = "{line}"\nunits = "1-3"\n'
        (self.folder / "gateway.toml").write_text(settings)
        gateway = self.start("gateway", ["strace", "-D", "-f", "-qq", "-o", "calls", root /
                                         "usr/bin/etcm-gateway", "--config", "gateway.toml"])
        gateway.wait_for_line(r"node 3 joined")
        if address := re.search(r"http://127\.0\.0\.1:\d+", gateway.log()):
            for path in ("", "metrics", "mesh.geojson", "healthz"):
                urllib.request.urlopen(f"{address.group()}/{path}", timeout=PATIENCE_S).read()
        self.assertEqual(gateway.stop(), 0, gateway.log())
        made = set(re.findall(r"^\d+ +(\w+)\(", (self.folder / "calls").read_text(), re.M))
        self.assertIn("epoll_wait", made)
        # What starts a program is done before the filter holds.
        self.assertEqual(made - allowed - {"execve", "arch_prctl"}, set())


class Life(ProgramCase):
    def setUp(self):
        super().setUp()
        self.root = self.folder / "system"
        for path in ("var/lib/dpkg/updates", "var/lib/dpkg/info", "usr/bin", "etc/systemd/system",
                     "var/lib/systemd", "tmp"):
            (self.root / path).mkdir(parents=True)
        for path in ("status", "available"):
            (self.root / "var/lib/dpkg" / path).touch()
        (self.root / "etc/passwd").write_text("root:x:0:0:root:/root:/bin/sh\n")
        (self.root / "etc/group").write_text("root:x:0:\ndialout:x:20:\n")
        self.before = self.left()

    def left(self):
        """Files of the system, those of dpkg and of the group apart."""
        return [path for path in files_under(self.root)
                if not path.startswith(("var/lib/dpkg/", "etc/group", "etc/gshadow", "etc/.pwd"))]

    def dpkg(self, *arguments):
        return run("dpkg", f"--root={self.root}", "--force-script-chrootless", "--force-depends",
                   "--force-confdef", "--log=/dev/null", *arguments)

    def test_installed_started_upgraded_removed_and_purged(self):
        settings = self.root / "etc/etcm/gateway.toml"
        enabled = self.root / "etc/systemd/system/multi-user.target.wants/etcm-gateway.service"
        gateway = self.root / "usr/bin/etcm-gateway"
        self.dpkg("-i", with_version(self.folder, "0.0.1"))
        self.assertTrue(enabled.is_symlink(), "not enabled")
        self.assertIn("gpio", (self.root / "etc/group").read_text())
        self.assertIn("good", run(gateway, "--config", settings, "--check-config"))

        # What the owner changes, so that it also runs here.
        state = self.root / "var/lib/etcm"
        mine = re.sub(r'(?m)^(listen = "127.0.0.1):\d+', r"\1:0", settings.read_text())
        mine = mine.replace("/var/lib/etcm", str(state))
        settings.write_text(mine)
        program = self.start("gateway", [gateway, "--config", settings])
        program.wait_for_line(r"serves the mesh on 127.0.0.1:\d+")
        self.assertEqual(program.stop(), 0, program.log())
        self.assertTrue((state / "mesh").is_dir())

        self.dpkg("-i", GATEWAY)
        self.assertEqual(settings.read_text(), mine, "an upgrade has overwritten the settings")
        self.assertTrue(enabled.is_symlink(), "no longer enabled")
        enabled.unlink()
        self.dpkg("-i", GATEWAY)
        self.assertFalse(enabled.is_symlink(), "enabled again against its owner's will")

        self.dpkg("-r", "etcm-gateway")
        self.assertFalse(gateway.exists())
        self.assertEqual(settings.read_text(), mine)
        self.assertTrue((state / "mesh").is_dir(), "its state is gone before the purge")

        self.dpkg("-P", "etcm-gateway")
        self.assertEqual(self.left(), self.before)
        self.assertFalse(state.exists())

    def test_what_a_purge_leaves_is_the_users(self):
        self.dpkg("-i", GATEWAY)
        site = self.root / "etc/etcm/site.poly"
        site.write_text("0 2\n0\n0\n")
        self.dpkg("-P", "etcm-gateway")
        self.assertTrue(site.is_file())
        site.unlink()
        self.assertEqual(self.left(), self.before)


if __name__ == "__main__":
    if os.geteuid() != 0 or shutil.which("dpkg") is None:
        print("needs root and dpkg; skipped")
        sys.exit(SKIPPED)
    unittest.main(verbosity=2)
