"""Certificates made by openssl, for tests: right ones, and wrong ones of each kind."""
import subprocess

from programs import PATIENCE_S


def openssl(folder, *arguments):
    done = subprocess.run(["openssl", *map(str, arguments)], cwd=folder, capture_output=True,
                          text=True, timeout=PATIENCE_S)
    assert done.returncode == 0, f"{arguments}\n{done.stdout}{done.stderr}"


def make_key(folder, name, subject, *more):
    openssl(folder, "req", *more, "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
            "-subj", f"/CN={subject}", "-keyout", f"{name}.key")


def make_ca(folder, name, subject):
    make_key(folder, name, subject, "-x509", "-days", "30", "-out", f"{name}.pem")


def make_certificate(folder, name, subject, ca, names="", days=("", "")):
    """name.pem and name.key, signed by ca.pem. `names`: whom it is for, as "DNS:a,IP:127.0.0.1".
    `days`: from and to, as "20200101000000Z"; empty: now, and long from now."""
    make_key(folder, name, subject, "-out", f"{name}.csr")
    database = folder / f"{name}.ca"
    database.mkdir()
    (database / "index.txt").touch()
    (database / "extensions").write_text(f"[e]\n{f'subjectAltName={names}' if names else ''}\n")
    (database / "ca.conf").write_text(f"""[ca]
default_ca = here
[here]
database = {database}/index.txt
new_certs_dir = {database}
rand_serial = yes
default_md = sha256
default_days = 30
policy = any
[any]
commonName = supplied
""")
    when = [part for option, day in zip(("-startdate", "-enddate"), days) if day
            for part in (option, day)]
    openssl(folder, "ca", "-batch", "-notext", "-config", database / "ca.conf", "-cert",
            f"{ca}.pem", "-keyfile", f"{ca}.key", "-in", f"{name}.csr", "-out", f"{name}.pem",
            "-extfile", database / "extensions", "-extensions", "e", *when)
