#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Completions in real shells, the manual page, and the list of operations for programs.
Usage: shell_help_test.py PROGRAM"""
import json
import os
import pathlib
import pty
import re
import select
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = sys.argv.pop(1)
FLAG = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")


def output(*words):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=True, timeout=60).stdout


OPERATIONS = [operation["name"] for operation in json.loads(output("list", "--json"))]


def help_flags(*words):
    return set(FLAG.findall(output(*words, "--help")))


class ShellHelp(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)

    def tearDown(self):
        self.temporary.cleanup()

    def script(self, shell):
        path = self.folder / f"completions.{shell}"
        path.write_text(output("completions", shell))
        return path

    def bash(self, *words):
        """What bash proposes for the last of the words."""
        ask = 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _formwright 2>/dev/null; printf "%s\\n" "${COMPREPLY[@]}"'
        done = subprocess.run(["bash", "-c", ask, "bash", self.script("bash"), "formwright", *words], capture_output=True, text=True, check=True, cwd=self.folder)
        return done.stdout.split()

    def fish(self, line):
        done = subprocess.run(["fish", "--no-config", "-c", "source $argv[1]; complete -C $argv[2]", self.script("fish"), line], capture_output=True, text=True, check=True,
                              cwd=self.folder, env={**os.environ, "HOME": str(self.folder)})
        return [proposal.split("\t")[0] for proposal in done.stdout.splitlines()]

    def zsh(self, typed):
        """What stands on the line of a terminal after `typed` and a tab."""
        script = self.script("zsh")
        child, terminal = pty.fork()
        if child == 0:
            os.chdir(self.folder)
            os.execvpe("zsh", ["zsh", "-f", "-i"], {**os.environ, "PS1": "READY ", "TERM": "dumb", "HOME": str(self.folder), "COLUMNS": "200"})
        seen = b""

        def until(wanted, seconds=60):
            nonlocal seen
            limit = time.monotonic() + seconds
            while wanted not in seen and time.monotonic() < limit:
                if select.select([terminal], [], [], 0.2)[0]:
                    seen += os.read(terminal, 65536)
            self.assertIn(wanted, seen)

        try:
            os.write(terminal, f"unsetopt zle_bracketed_paste; autoload -U compinit; compinit -u -D; source {script}; echo LOA''DED\n".encode())
            until(b"LOADED")
            seen = b""
            os.write(terminal, typed.encode() + b"\t")
            time.sleep(0.1)
            os.write(terminal, b"\x01echo \x05 ENDED\n")  # the line as it stands is printed: `echo` before it
            until(b"ENDED\r\n")
        finally:
            os.write(terminal, b"\x03exit\n")
            os.close(terminal)
            os.waitpid(child, 0)
        return seen.decode()

    def test_the_list_for_programs_is_the_catalog(self):
        catalog = json.loads(output("describe"))["operations"]
        self.assertEqual([operation["name"] for operation in catalog], OPERATIONS)
        self.assertEqual([line.split("\t")[0] for line in output("list").splitlines()], OPERATIONS)
        wrong = subprocess.run([PROGRAM, "list", "--xml"], capture_output=True, text=True)
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("--xml", wrong.stderr)

    def test_commands_and_flags_are_completed_in_bash(self):
        self.assertEqual(sorted(self.bash("reli")), ["relief", "relief-forest", "relief-light"])
        self.assertLessEqual({*OPERATIONS, "serve", "machine", "list", "describe", "completions", "manual"}, set(self.bash("")))
        self.assertEqual(self.bash("relief", "--thick"), ["--thickness-mm"])
        self.assertEqual(self.bash("relief", "--projection", ""), ["perspective", "orthographic"])
        self.assertIn("relief", self.bash("describe", "rel"))
        self.assertEqual(self.bash("relief", "--thickness-mm", ""), [])
        (self.folder / "a_model.obj").touch()
        (self.folder / "a_folder").mkdir()
        self.assertEqual(sorted(self.bash("relief", "--mesh", "a_")), ["a_folder", "a_model.obj"])
        self.assertEqual(self.bash("relief", "--out", "a_"), ["a_folder"])

    def test_every_flag_of_the_help_is_completed(self):
        for words in [(name,) for name in OPERATIONS] + [("serve",), ("machine",)]:
            with self.subTest(words[0]):
                self.assertEqual(set(FLAG.findall(" ".join(self.bash(*words, "--")))) - {"--help"}, help_flags(*words) - {"--help"})

    def test_commands_and_flags_are_completed_in_fish(self):
        self.assertEqual(sorted(self.fish("formwright reli")), ["relief", "relief-forest", "relief-light"])
        self.assertEqual(self.fish("formwright relief --thick"), ["--thickness-mm"])
        self.assertEqual(sorted(self.fish("formwright relief --projection ")), ["orthographic", "perspective"])
        self.assertEqual(set(self.fish("formwright relief --")) - {"--help"}, help_flags("relief") - {"--help"})
        self.assertEqual(sorted(self.fish("formwright completions ")), ["bash", "fish", "zsh"])

    def test_commands_and_flags_are_completed_in_zsh(self):
        self.assertIn("formwright relief ENDED", self.zsh("formwright reli"))
        self.assertIn("formwright relief --thickness-mm ENDED", self.zsh("formwright relief --thick"))
        self.assertIn("formwright relief --projection orthographic ENDED", self.zsh("formwright relief --projection orth"))
        self.assertIn("formwright machine remove ENDED", self.zsh("formwright machine rem"))

    def test_another_shell_is_refused(self):
        for words in (["completions"], ["completions", "tcsh"]):
            wrong = subprocess.run([PROGRAM, *words], capture_output=True, text=True)
            self.assertEqual(wrong.returncode, 2)
            self.assertIn("bash, zsh or fish", wrong.stderr)

    def test_the_manual_is_read_without_a_warning_and_names_everything(self):
        page = self.folder / "formwright.1"
        page.write_text(output("manual"))
        read = subprocess.run(["groff", "-man", "-Kutf8", "-Tutf8", "-ww", "-rLL=200n", "-P-c", page], capture_output=True, text=True, check=True)
        self.assertEqual(read.stderr, "")
        text = re.sub(r".\x08", "", read.stdout)
        for name in OPERATIONS:
            self.assertLessEqual(help_flags(name) - {"--help"}, set(FLAG.findall(text)), name)
            self.assertIn(f"formwright {name} ", text)


if __name__ == "__main__":
    unittest.main(verbosity=2)
