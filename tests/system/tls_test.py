"""A gateway at a broker with TLS, by certificates that openssl makes here and by keys: what is right
connects, each thing that is wrong is told with its cure. The programs' folder is in ETCM_BIN."""
import pathlib
import socket
import subprocess
import sys
import threading
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from broker import SITE, Broker
from certificates import make_ca, make_certificate
from gateway_test import PROGRAMS
from mqtt_test import MqttCase
from programs import PATIENCE_S

LONG_AGO = ("20200101000000Z", "20210101000000Z")
NOT_YET = ("20900101000000Z", "20910101000000Z")
KEY = "00112233445566778899aabbccddeeff"


class TlsCase(MqttCase):
    def start_client(self, program, broker, host="localhost", **keys):
        lines = "\n".join(f'{key} = "{value}"' for key, value in keys.items())
        config = self.folder / f"{program}.toml"
        config.write_text(f"""
[mesh]
vertices_max = 100
[server]
listen = "127.0.0.1:0"
[mqtt]
broker = "{host}:{broker.port}"
site = "{SITE}"
name = "north"
share = "site"
{lines}
""")
        return self.start(program, [PROGRAMS / "etcm-gateway", "--config", config])

    def expect(self, words, program, broker, **more):
        self.start_client(program, broker, **more).wait_for_line(words)


class Certificates(TlsCase):
    def setUp(self):
        super().setUp()
        make_ca(self.folder, "ca", "Harbour CA")
        make_ca(self.folder, "other", "Somebody Else")
        make_certificate(self.folder, "north", "north", "ca")
        make_certificate(self.folder, "stranger", "north", "other")
        (self.folder / "certs").mkdir()
        self.me = {"tls_ca": "ca.pem", "tls_certificate": "north.pem", "tls_key": "north.key"}

    def start_broker(self, name, names="DNS:localhost,IP:127.0.0.1", ca="ca", days=("", "")):
        """One that shows such a certificate, and wants one that ca.pem has signed."""
        make_certificate(self.folder, name, "broker", ca, names, days)
        (self.folder / "certs/ca.pem").write_text((self.folder / "ca.pem").read_text())
        for kind in ("pem", "key"):
            (self.folder / f"certs/broker.{kind}").write_text(
                (self.folder / f"{name}.{kind}").read_text())
        return Broker(self, "etcm-tls.conf", name)

    def test_what_is_right_connects_and_may_write_what_is_its_own(self):
        broker = self.start_broker("right")
        for host in ("localhost", "127.0.0.1"):
            gateway = self.start_client(host, broker, host=host, **self.me)
            gateway.wait_for_line(f"connected as {SITE}:north")
            # By the name in its certificate.
            broker.program.wait_for_line(f"Received PUBLISH from {SITE}:north .*north/header")
            gateway.stop()
            self.assertNotIn("trying again", gateway.log())

    def test_what_is_wrong_with_the_broker_is_told(self):
        right = self.start_broker("right")
        self.expect("no CA of .*other.pem has signed its certificate, but Harbour CA has; put the "
                    "certificate of that one into tls_ca, if it is to be trusted; trying again",
                    "wrong_ca", right, **self.me | {"tls_ca": "other.pem"})
        self.expect(r"its certificate has expired, on 2021-01-01 00:00 UTC; renew it at the broker "
                    r"\(here it is 2\d+-\d\d-\d\d \d\d:\d\d UTC: if that is wrong, set the clock\)",
                    "expired_at", self.start_broker("expired", days=LONG_AGO), **self.me)
        self.expect("its certificate is not valid before 2090-01-01 00:00 UTC; here it is .*: set "
                    "the clock", "early_at", self.start_broker("early", days=NOT_YET), **self.me)
        named = self.start_broker("named", "DNS:mqtt.example,DNS:other.example,IP:192.0.2.1,IP:::1")
        self.expect("its certificate is for mqtt.example, other.example, 192.0.2.1, "
                    "0:0:0:0:0:0:0:1, and not for localhost; give `broker` a name that is in the "
                    "certificate, or make one for localhost", "name_at", named, **self.me)
        self.expect("and not for 127.0.0.1; give", "address_at", named, host="127.0.0.1", **self.me)

    def test_what_is_wrong_with_the_gateway_is_told(self):
        right = self.start_broker("right")
        self.expect("the broker wants a certificate of the gateway; give tls_certificate and tls_key",
                    "without", right, tls_ca="ca.pem")
        self.expect("the broker does not trust the CA of tls_certificate; have it signed by the "
                    "broker's", "untrusted", right,
                    **self.me | {"tls_certificate": "stranger.pem", "tls_key": "stranger.key"})
        make_certificate(self.folder, "old", "north", "ca", days=LONG_AGO)
        self.expect("tls_certificate has expired; renew it", "too_old", right,
                    **self.me | {"tls_certificate": "old.pem", "tls_key": "old.key"})

    def test_what_the_broker_does_not_allow_names_who_is_shown(self):
        right = self.start_broker("right")
        make_certificate(self.folder, "south", "south", "ca")
        self.expect(r"message for etcm/v1/.*/north/.* is refused: its access list does not allow "
                    "that to the certificate or key of 'south'; allow it there",
                    "another", right,
                    **self.me | {"tls_certificate": "south.pem", "tls_key": "south.key"})

    def test_files_that_are_of_no_use_end_it_with_the_cure(self):
        (self.folder / "text").write_text("no certificate\n")
        (self.folder / "text").chmod(0o600)
        right = self.start_broker("right")
        for keys, words in (
                ({"tls_ca": "text"}, r"text \(.*\); tls_ca must be a file in PEM"),
                ({"tls_certificate": "text"}, r"text \(.*\); tls_certificate must be a file in PEM"),
                ({"tls_key": "text"}, r"text \(.*\); tls_key must be a file in PEM"),
                ({"tls_key": "stranger.key"}, r"stranger.key \(.*\); tls_key must be a file in PEM")):
            program = "_".join(keys) + "_" + "_".join(keys.values())
            with self.subTest(program):
                gateway = self.start_client(program, right, **self.me | keys)
                gateway.wait_for_line(words)
                self.assertEqual(gateway.process.wait(PATIENCE_S), 2)
                done = subprocess.run([PROGRAMS / "etcm-gateway", "--check-config", "--config",
                                       self.folder / f"{program}.toml"],
                                      capture_output=True, text=True, timeout=PATIENCE_S)
                self.assertEqual(done.returncode, 2)
                self.assertRegex(done.stderr, words)

    def test_a_port_of_the_other_kind_is_told(self):
        right = self.start_broker("right")
        self.expect("(connection closed by the other side|Connection reset by peer) before it "
                    "answered; give the port of a broker for MQTT, and tls_ca or psk_file where it "
                    "wants TLS", "plain", right)
        with socket.create_server(("127.0.0.1", 0)) as server:
            server.settimeout(60)

            def answer():
                with server.accept()[0] as client:
                    client.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")
                    client.recv(1000)
            thread = threading.Thread(target=answer)
            thread.start()
            right.port = server.getsockname()[1]
            self.expect("what answers does not speak TLS; give the port that does", "http", right,
                        **self.me)
            thread.join()


class Keys(TlsCase):
    def test_of_keys_the_right_one_connects_and_a_wrong_one_is_told(self):
        (self.folder / "etcm.psk").write_text(f"north:{KEY}\n")
        broker = Broker(self, "etcm-psk.conf")
        self.write_secret("key", KEY)
        self.write_secret("wrong", KEY[::-1])
        gateway = self.start_client("right", broker, psk_identity="north", psk_file="key")
        gateway.wait_for_line(f"connected as {SITE}:north")
        # By the name of its key.
        broker.program.wait_for_line(f"Received SUBSCRIBE from {SITE}:north")
        self.expect("the key in psk_file is not the one that the broker has for psk_identity; give "
                    "both the same, such as by the install.sh of its folder once more, and restart "
                    "this; trying again", "wrong_key", broker, psk_identity="north",
                    psk_file="wrong")
        self.expect("the broker does not know psk_identity; add it there, or correct it here",
                    "nobody", broker, psk_identity="nobody", psk_file="key")


if __name__ == "__main__":
    unittest.main(verbosity=2)
