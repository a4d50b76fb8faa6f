"""Who is told what, and who can keep others out: names, and many connections, against the real gateway.

ETCM_BIN is the programs' folder. Every wait is for a condition.
"""
import http.client
import signal
import socket
import struct
import unittest
from urllib.parse import urlsplit

from browser import PageCase, open_browser
from gateway_test import THREE, PATIENCE_S, wait_for

SLOW_CLIENTS = 200
# This machine has all of 127.0.0.0/8.
VISITOR = "127.0.0.2"


class Access(PageCase):
    def ask(self, path, host, source=None):
        """Status and text of an answer to a request with this Host."""
        page = urlsplit(self.url)
        connection = http.client.HTTPConnection(
            page.hostname, page.port, timeout=PATIENCE_S, source_address=source and (source, 0))
        connection.request("GET", path, headers={"Host": host})
        answer = connection.getresponse()
        text = answer.read().decode()
        connection.close()
        return answer.status, text

    def test_a_name_is_known_when_it_has_been_told(self):
        gateway = self.start_page(THREE)
        self.wait_for_header(nodes=3)
        port = urlsplit(self.url).port
        for host in (f"127.0.0.1:{port}", "localhost", "[::1]"):
            self.assertEqual(self.ask("/healthz", host), (200, "ok\n"))
        for path in ("/", "/mesh.json", "/mesh.geojson", "/status.json", "/ages.json", "/metrics"):
            status, text = self.ask(path, f"etcm.example:{port}")
            self.assertEqual(status, 421)
            self.assertIn('names = ["etcm.example"]', text)
        gateway.wait_for_line(r"asks for the page by the name etcm\.example and is told nothing")
        config = self.folder / "site.toml"
        config.write_text(config.read_text().replace("[http]", '[http]\nnames = ["ETCM.example"]'))
        gateway.process.send_signal(signal.SIGHUP)
        wait_for("a page by that name", lambda: self.ask("/", "etcm.example")[0] == 200)
        self.assertEqual(self.ask("/", "evil.example")[0], 421)

    def test_a_page_of_another_site_reads_nothing_through_a_browser(self):
        """Its name leads to the gateway, as that of any site may when it likes."""
        self.start_page(THREE)
        self.wait_for_header(nodes=3)
        browser = open_browser("--host-resolver-rules=MAP evil.example 127.0.0.1")
        try:
            port = urlsplit(self.url).port
            browser.get(f"http://evil.example:{port}/")
            text = browser.execute_script("return document.body.innerText")
            self.assertIn("421: this gateway is not known by the name", text)
            # The browser takes what it asks for as its own, so this is all that is in the way.
            status = browser.execute_async_script(
                "const done = arguments[0];"
                "fetch('/mesh.json').then(answer => done(answer.status), e => done(String(e)));")
            self.assertEqual(status, 421)
            browser.get(f"http://localhost:{port}/")
            wait_for("the page", lambda: "3" in browser.execute_script(
                "return document.querySelector('#counts')?.innerText ?? ''"))
        finally:
            browser.quit()

    def slow_clients(self, port):
        """Connections that say nothing; those beyond the share are closed."""
        clients = []
        for _ in range(SLOW_CLIENTS):
            client = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
            client.setblocking(False)
            clients.append(client)
        return clients

    @staticmethod
    def is_open(client):
        try:
            return client.recv(1) != b""
        except BlockingIOError:
            return True
        except OSError:
            return False

    def test_many_slow_clients_of_one_address_delay_nobody_else_at_the_page(self):
        self.start_page(THREE)
        clients = self.slow_clients(urlsplit(self.url).port)
        status, _ = self.ask("/healthz", "localhost", source=VISITOR)
        held = sum(self.is_open(client) for client in clients)
        self.assertEqual(status, 200)
        self.assertLessEqual(held, 24)
        for client in clients:
            client.close()

    def test_many_slow_clients_of_one_address_delay_nobody_else_at_the_registers(self):
        self.start_page(THREE)
        clients = self.slow_clients(self.port)
        with socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE_S,
                                      source_address=(VISITOR, 0)) as visitor:
            visitor.sendall(struct.pack(">HHHBBHH", 1, 0, 6, 1, 4, 2, 1))
            answer = visitor.recv(260)
        self.assertEqual(answer[7:9], b"\x04\x02")
        self.assertEqual(answer[9:11], b"\x4d\x45", "the magic of the header")
        wait_for("the others hung up on",
                 lambda: sum(self.is_open(client) for client in clients) <= 12)
        for client in clients:
            client.close()


if __name__ == "__main__":
    unittest.main()
