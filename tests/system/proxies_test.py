"""The page behind nginx, and the mesh behind stunnel, by the examples that come with the package: who
gets in, and who does not. The programs' folder is in ETCM_BIN."""
import base64
import json
import pathlib
import re
import socket
import ssl
import struct
import subprocess
import sys
import unittest
import urllib.error
import urllib.request

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from broker import EXAMPLES
from certificates import make_ca, make_certificate
from gateway_test import GatewayCase
from programs import PATIENCE_S, free_port, wait_for

HEADER = struct.pack(">HHHBBHH", 7, 0, 6, 1, 4, 0, 4)  # the first four registers of unit 1


class ProxyCase(GatewayCase):
    def setUp(self):
        super().setUp()
        make_ca(self.folder, "ca", "Harbour CA")
        make_ca(self.folder, "other", "Somebody Else")
        self.ports = {}

    def example(self, path, replaced):
        """An example with its files in the folder of the test, and with other ports."""
        text = (EXAMPLES / path).read_text().replace("/etc/etcm/tls", str(self.folder))
        for old, new in replaced.items():
            self.assertIn(old, text)
            text = text.replace(old, new)
        return text

    def wait_for_port(self, port):
        def is_open():
            with socket.socket() as probe:
                return probe.connect_ex(("127.0.0.1", port)) == 0
        wait_for(f"somebody at port {port}", is_open)

    def trusting(self, ca="ca", certificate=None):
        context = ssl.create_default_context(cafile=self.folder / f"{ca}.pem")
        if certificate:
            context.load_cert_chain(self.folder / f"{certificate}.pem",
                                    self.folder / f"{certificate}.key")
        return context


class Page(ProxyCase):
    def setUp(self):
        super().setUp()
        make_certificate(self.folder, "page", "mesh", "ca", "DNS:localhost")
        gateway = self.start_gateway(self.start_nodes(["0,1,join,0,0"]),
                                     '[http]\nlisten = "127.0.0.1:0"\n')
        page = gateway.wait_for_line(r"page on http://(\S+) ").group(1)
        done = subprocess.run(["openssl", "passwd", "-6", "secret"], capture_output=True, text=True,
                              timeout=PATIENCE_S, check=True)
        (self.folder / "etcm.users").write_text(f"viewer:{done.stdout}")
        self.secure = free_port()
        site = self.example("nginx/etcm.conf",
                            {"listen 443": f"listen 127.0.0.1:{self.secure}",
                             "127.0.0.1:8080;": f"{page};",
                             "/etc/nginx/etcm.users": str(self.folder / "etcm.users")})
        self.folder.chmod(0o755)  # for the worker of nginx, which is another user
        places = "\n".join(f"{kind}_temp_path {self.folder}/{kind};" for kind in
                           ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        (self.folder / "nginx.conf").write_text(
            f"daemon off;\npid {self.folder}/nginx.pid;\nerror_log stderr;\nevents {{}}\n"
            f"http {{\naccess_log off;\n{places}\n{site}\n}}\n")
        self.start("nginx", ["/usr/sbin/nginx", "-p", self.folder, "-c", self.folder / "nginx.conf",
                             "-e", "stderr"])
        self.wait_for_port(self.secure)

    def get(self, path, user="viewer:secret", ca="ca", data=None):
        request = urllib.request.Request(f"https://localhost:{self.secure}{path}", data=data)
        if user:
            request.add_header("Authorization",
                               "Basic " + base64.b64encode(user.encode()).decode())
        with urllib.request.urlopen(request, timeout=PATIENCE_S,
                                    context=self.trusting(ca)) as answer:
            return answer.read().decode()

    def test_it_is_there_with_tls_and_a_password_alone(self):
        self.wait_for_header(nodes=1)
        self.assertIn("features", json.loads(self.get("/mesh.geojson")))
        self.assertIn("<html", self.get("/"))
        for user in (None, "viewer:wrong", "nobody:secret"):
            with self.subTest(user=user), self.assertRaises(urllib.error.HTTPError) as refused:
                self.get("/status.json", user)
            self.assertEqual(refused.exception.code, 401)
        with self.assertRaises(urllib.error.HTTPError) as refused:
            self.get("/status.json", data=b"x")
        self.assertEqual(refused.exception.code, 403)
        with self.assertRaises(urllib.error.URLError):
            self.get("/status.json", ca="other")
        with socket.create_connection(("127.0.0.1", self.secure), timeout=PATIENCE_S) as plain:
            plain.sendall(b"GET /status.json HTTP/1.0\r\n\r\n")
            self.assertIn(b" 400 ", plain.recv(1000))


class ModbusSecurity(ProxyCase):
    def setUp(self):
        super().setUp()
        make_certificate(self.folder, "modbus", "mesh", "ca", "DNS:localhost")
        make_certificate(self.folder, "master", "scada", "ca")
        make_certificate(self.folder, "stranger", "scada", "other")
        self.start_gateway(self.start_nodes(["0,1,join,0,0"]))
        self.wait_for_header(nodes=1)
        self.secure = free_port()
        self.start_stunnel("server", {":::802": f"127.0.0.1:{self.secure}",
                                      "127.0.0.1:1502": f"127.0.0.1:{self.port}"})
        self.wait_for_port(self.secure)

    def start_stunnel(self, end, replaced):
        path = self.folder / f"stunnel-{end}.conf"
        path.write_text("foreground = yes\npid =\n" +
                        self.example(f"stunnel/modbus-{end}.conf", replaced))
        return self.start(f"stunnel-{end}", ["stunnel", path])

    def ask(self, certificate=None, ca="ca"):
        """What comes back, by a master that speaks TLS itself."""
        with socket.create_connection(("127.0.0.1", self.secure), timeout=PATIENCE_S) as link:
            with self.trusting(ca, certificate).wrap_socket(link, server_hostname="localhost") as tls:
                tls.sendall(HEADER)
                return tls.recv(100)

    def test_masters_with_a_certificate_of_the_ca_read_and_nobody_else(self):
        answer = self.ask("master")
        self.assertEqual(answer[:9], struct.pack(">HHHBBB", 7, 0, 11, 1, 4, 8))
        self.assertEqual(answer[13:15], struct.pack(">H", 0x4D45))
        for certificate in (None, "stranger"):
            with self.subTest(certificate=certificate):
                try:
                    self.assertEqual(self.ask(certificate), b"")
                except (ssl.SSLError, ConnectionError):
                    pass
        with socket.create_connection(("127.0.0.1", self.secure), timeout=PATIENCE_S) as plain:
            plain.sendall(HEADER)
            try:
                self.assertNotIn(struct.pack(">H", 0x4D45), plain.recv(1000))
            except ConnectionError:
                pass

    def test_a_master_without_tls_reads_by_the_other_end(self):
        port = free_port()
        self.start_stunnel("client", {"127.0.0.1:502": f"127.0.0.1:{port}",
                                      "mesh.example:802": f"127.0.0.1:{self.secure}",
                                      "mesh.example": "localhost"})
        self.wait_for_port(port)
        done = subprocess.run(["mbpoll", "-m", "tcp", "-p", str(port), "-a", "1", "-t", "3", "-0",
                               "-r", "0", "-c", "4", "-1", "127.0.0.1"],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(re.findall(r"^\[2\]:\s+(\d+)", done.stdout, re.M), [str(0x4D45)])


if __name__ == "__main__":
    unittest.main(verbosity=2)
