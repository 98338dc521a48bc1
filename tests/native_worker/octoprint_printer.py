# SPDX-License-Identifier: GPL-3.0-or-later
"""OctoPrint's virtual Marlin printer at a pseudo terminal, without the rest of OctoPrint. Prints the terminal's name.
Usage: PEERS/bin/python octoprint_printer.py FOLDER [SETTING=JSON ...]
The settings are the plugin's own, and spoil_percent: how many of the lines arrive with a letter changed. (Its own resend_ratio throws lines away
that it does not ask for again.)

What is read from stdin, one line each: "debug WORDS" goes to the printer as its own !!DEBUG command; "look" prints what it has done, as JSON."""
import json
import os
import pathlib
import pty
import random
import sys
import threading
import tty
from types import SimpleNamespace

from octoprint.plugins.virtual_printer import VirtualPrinterPlugin, virtual

virtual.plugin_manager = lambda: SimpleNamespace(get_hooks=lambda name: {})


class Settings:
    """What a plugin is given of OctoPrint's settings: its defaults, and what the caller wants otherwise."""

    def __init__(self, folder: pathlib.Path, changed: dict):
        self.folder = folder
        self.values = {**VirtualPrinterPlugin.get_settings_defaults(None), **changed}

    def get(self, path: list, **_):
        value = self.values
        for name in path:
            value = value[name]
        return value

    def get_int(self, path): return int(self.get(path))
    def get_float(self, path): return float(self.get(path))
    def get_boolean(self, path): return bool(self.get(path))
    def global_get_basefolder(self, name): return str(self.folder)


class Printer(virtual.VirtualPrinter):
    """The same, and remembers the moves in the order in which it took them, and what it refused."""

    def __init__(self, *words):
        self.moves, self.moved, self.refusals = [], 0, 0
        super().__init__(*words)

    def _gcode_G0(self, data):
        self.moves.append(data)
        super()._gcode_G0(data)

    _gcode_G1 = _gcode_G0

    def _performMove(self, line):
        super()._performMove(line)
        self.moved += 1

    def _triggerResend(self, *words, **named):
        self.refusals += 1
        super()._triggerResend(*words, **named)

    def look(self) -> dict:
        return {"moves": self.moves, "moved": self.moved, "refusals": self.refusals, "position_mm": [self._lastX, self._lastY, self._lastZ],
                "targets_c": [self.targetTemp[0], self.bedTargetTemp], "hotend_c": self.temp[0], "feed_percent": self._feedrate_multiplier,
                "halted": self._killed, "last_number": self.lastN}


def main() -> None:
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    changed = dict((word.split("=", 1)[0], json.loads(word.split("=", 1)[1])) for word in sys.argv[2:])
    spoil, chance = changed.pop("spoil_percent", 0) / 100, random.Random(1)
    printer = Printer(Settings(folder, changed), None, str(folder), None, 0.2)
    host, machine = pty.openpty()
    tty.setraw(machine)
    print(os.ttyname(machine), flush=True)

    def say() -> None:
        while printer.outgoing is not None:
            line = printer.readline()
            if line:
                os.write(host, line.rstrip(b"\n") + b"\n")

    def listen() -> None:
        line = b""
        while True:
            line += os.read(host, 256)
            # It looks at one line a turn.
            while b"\n" in line:
                one, line = line.split(b"\n", 1)
                take(spoiled(one) + b"\n")

    def spoiled(one: bytes) -> bytes:
        first, last = one.find(b" "), one.rfind(b"*")
        if not one.startswith(b"N") or last < first + 2 or chance.random() >= spoil:
            return one
        at = chance.randrange(first + 1, last)
        return one[:at] + bytes([one[at] ^ 0x04]) + one[at + 1:]

    def take(one: bytes) -> None:
        while one and printer.incoming is not None:
            one = one[printer.write(one):]

    for work in (say, listen):
        threading.Thread(target=work, daemon=True).start()
    for request in sys.stdin:
        if request.startswith("debug "):
            printer._debugTrigger(request[6:].strip())
        else:
            print(json.dumps(printer.look()), flush=True)
    os._exit(0)


main()
