"""What the command lines of all programs have alike. The programs' folder is in ETCM_BIN, the version in
ETCM_VERSION."""
import os
import pathlib
import shlex
import subprocess
import unittest

PROGRAMS = sorted(pathlib.Path(os.environ["ETCM_BIN"]).glob("etcm*"))
COMPLETION = pathlib.Path(__file__).resolve().parents[3] / "port" / "command_line"
VERSION = os.environ["ETCM_VERSION"]


def run(program, *arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, timeout=60,
                          stdin=subprocess.DEVNULL)


class CommandLines(unittest.TestCase):
    def test_there_are_some(self):
        self.assertIn("etcm", [program.name for program in PROGRAMS])

    def test_each_tells_its_version(self):
        for program in PROGRAMS:
            with self.subTest(program.name):
                done = run(program, "--version")
                self.assertEqual((done.returncode, done.stdout, done.stderr),
                                 (0, f"{program.name} {VERSION}\n", ""))

    def test_each_tells_what_it_does(self):
        for program in PROGRAMS:
            with self.subTest(program.name):
                done = run(program, "--help")
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                self.assertIn("--version", done.stdout)

    def test_output_that_cannot_be_written_is_told(self):
        lines = [[program, word] for program in PROGRAMS for word in ("--version", "--help")]
        lines += [[program, word] for program in PROGRAMS if program.name == "etcm-gateway"
                  for word in ("--settings", "--settings-table", "--register-map")]
        for line in lines:
            with self.subTest(line[0].name, word=line[1]), open("/dev/full", "w") as full:
                done = subprocess.run(line, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
                self.assertEqual((done.returncode, done.stderr),
                                 (1, f"{line[0].name}: the output cannot be written; "
                                     "make room for it, or give it another place\n"))

    def test_what_is_not_understood_is_told_in_one_line_and_ends_with_2(self):
        for program in PROGRAMS:
            takes_a_file = "[FILE]" in run(program, "--help").stdout
            for word in ("--nonsense",) if takes_a_file else ("--nonsense", "nonsense"):
                with self.subTest(program.name, word=word):
                    done = run(program, word)
                    self.assertEqual((done.returncode, done.stdout), (2, ""))
                    self.assertRegex(done.stderr, rf"\A{program.name}: [^\n]+ "
                                                  rf"\({program.name} --help tells more\)\n\Z")

    def test_a_word_that_nobody_knows_is_named_before_one_that_is_missing(self):
        for line in (["etcm-nodes", "--listn", "127.0.0.1:0"], ["etcm-bus", "scan", "--baude", "9600"],
                     ["etcm-gateway", "--confg", "x"], ["etcm", "mesh", "--polcy", "x"]):
            program = PROGRAMS[0].parent / line[0]
            if not program.exists():
                continue
            with self.subTest(line):
                done = run(program, *line[1:])
                wrong = next(word for word in line if word.startswith("--"))
                self.assertEqual((done.returncode, done.stdout), (2, ""))
                self.assertRegex(done.stderr, rf"\A{line[0]}: [^\n]*{wrong}")

    def test_bash_completes_commands_options_and_files(self):
        """As bash asks, with the words of a line, the last of them to be completed."""
        for line, wanted in ((["etcm", "me"], ["mesh"]), (["etcm", "mesh", "--pol"], ["--policy"]),
                             (["etcm-nodes", "--lis"], ["--listen"]),
                             (["etcm-bus", "scan", "--pari"], ["--parity"]),
                             (["etcm-gateway", "--reg"], ["--register-map"]),
                             (["etcm-gateway", "ctl", "dis"], ["dismiss"]),
                             (["etcm-gateway", "ctl", "list", "--j"], ["--json"]),
                             (["etcm", "mesh", "README"], ["README.md"])):
            if not (PROGRAMS[0].parent / line[0]).exists():
                continue
            with self.subTest(line):
                words = " ".join(shlex.quote(word) for word in line)
                script = (f"source etcm.bash; COMP_WORDS=({words}); COMP_CWORD={len(line) - 1}; "
                          f'_etcm {line[0]}; echo "${{COMPREPLY[@]}}"')
                path = f"{PROGRAMS[0].parent.resolve()}:{os.environ['PATH']}"
                done = subprocess.run(["bash", "-c", script], cwd=COMPLETION, capture_output=True,
                                      text=True, timeout=60, env=os.environ | {"PATH": path})
                self.assertEqual(sorted(set(done.stdout.split())), wanted, done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
