# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs that stand where machines stand, each on the loopback of a network of its own.
A test that imports this runs again in a network namespace, with a /run of its own, so that nothing is heard outside and no port is taken."""
import http.client
import json
import os
import pathlib
import queue
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request

if os.environ.get("FORMWRIGHT_OWN_NETWORK") != "yes":
    os.environ["FORMWRIGHT_OWN_NETWORK"] = "yes"
    flags = ["-n", "-m"] if os.geteuid() == 0 else ["-r", "-n", "-m"]
    os.execvp("unshare", ["unshare", *flags, sys.executable, *sys.argv])
# The name service allows one of itself a machine, by a file in /run.
subprocess.run(["mount", "-t", "tmpfs", "tmpfs", "/run"], check=True)
for ip in ("ip", "/usr/sbin/ip", "/sbin/ip"):
    if shutil.which(ip):
        subprocess.run([ip, "link", "set", "lo", "up"], check=True)
        break

PROGRAM, VIRTUAL_GRBL, PEERS = sys.argv.pop(1), sys.argv.pop(1), pathlib.Path(sys.argv.pop(1))


def wait_until(condition, seconds: float = 20, what: str = "it"):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.05)
    raise AssertionError(f"{what} did not happen within {seconds} s")


def end(process: subprocess.Popen) -> None:
    if process.poll() is None:
        process.terminate()
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    for stream in (process.stdin, process.stdout):
        if stream:
            stream.close()


def formwright(*words, data: pathlib.Path, **options):
    return subprocess.run([PROGRAM, "machine", words[0], "--data", str(data), *map(str, words[1:])], capture_output=True, text=True, timeout=120, **options)


def add_machine(data: pathlib.Path, name: str, url: str, *flags: str) -> str:
    run = formwright("add", "--name", name, "--url", url, *flags, data=data)
    assert run.returncode == 0, run.stderr
    return run.stdout.split()[0]


class VirtualGrbl:
    """The strict virtual GRBL at a pseudo terminal."""

    def __init__(self, *flags: str):
        self.process = subprocess.Popen([VIRTUAL_GRBL, *flags], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = self.process.stdout.readline().strip()

    def look(self) -> dict:
        self.process.stdin.write("?\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def stop(self) -> None:
        end(self.process)


class Printer:
    """ippeveprinter, with the bus and the name service that it needs, of their own."""

    SCRIPT = """#!/bin/sh
env | grep '^IPP_' | sort > "$SPOOL/job-$$.env"
cp "$1" "$SPOOL/job-$$.document"
while [ -e "$SPOOL/slow" ]; do sleep 0.1; done
mv "$SPOOL/job-$$.env" "$SPOOL/job-$$.done"
"""

    def __init__(self, folder: pathlib.Path, port: int, *flags: str, formats: str = "application/pdf,image/png,image/pwg-raster"):
        self.folder = folder
        self.spool = folder / "spool"
        self.spool.mkdir(parents=True)
        os.chmod(folder, 0o755)
        bus = folder / "bus"
        (folder / "bus.conf").write_text(
            '<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN" "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">\n'
            f"<busconfig><type>system</type><listen>unix:path={bus}</listen><auth>EXTERNAL</auth>"
            '<policy context="default"><allow send_destination="*" eavesdrop="true"/><allow eavesdrop="true"/><allow own="*"/></policy></busconfig>')
        (folder / "avahi.conf").write_text("[server]\nallow-interfaces=lo\nuse-ipv6=no\nenable-dbus=yes\nhost-name=formwright-test\n[publish]\npublish-workstation=no\n")
        self.environment = {**os.environ, "DBUS_SYSTEM_BUS_ADDRESS": f"unix:path={bus}", "SPOOL": str(self.spool), "PATH": os.environ["PATH"] + ":/usr/sbin"}
        self.processes = [subprocess.Popen(["dbus-daemon", f"--config-file={folder / 'bus.conf'}", "--nofork"], stderr=subprocess.DEVNULL)]
        wait_until(bus.exists, what="the bus")
        self.log = (folder / "printer.log").open("w")
        avahi_log = (folder / "avahi.log").open("w")
        self.processes.append(subprocess.Popen(["avahi-daemon", "--no-drop-root", "--no-chroot", "--no-rlimits", "-f", str(folder / "avahi.conf")], env=self.environment,
                                               stderr=avahi_log, stdout=avahi_log))
        avahi_log.close()
        wait_until(lambda: "startup complete" in (folder / "avahi.log").read_text(), what="the name service")
        script = folder / "print.sh"
        script.write_text(self.SCRIPT)
        script.chmod(0o755)
        self.url = f"ipp://localhost:{port}/ipp/print"
        self.processes.append(subprocess.Popen(["ippeveprinter", "-vv", "-p", str(port), "-n", "localhost", "-d", str(folder), "-c", str(script), "-f", formats, *flags, "Studio"],
                                               env=self.environment, stderr=self.log, stdout=self.log))
        wait_until(lambda: subprocess.run(["ipptool", "-q", "-T", "2", self.url, "get-printer-attributes.test"], capture_output=True).returncode == 0, what="the printer")

    def jobs(self) -> list[tuple[bytes, dict]]:
        """Document and IPP attributes of each job that was printed, oldest first."""
        found = []
        for done in sorted(self.spool.glob("*.done"), key=lambda p: p.stat().st_mtime_ns):
            attributes = dict(line.split("=", 1) for line in done.read_text().splitlines() if "=" in line)
            found.append((done.with_suffix(".document").read_bytes(), attributes))
        return found

    def state_of(self, job: int) -> str:
        """What the printer says of it: completed, canceled, processing..."""
        question = self.folder / "job.test"
        question.write_text("{ OPERATION Get-Job-Attributes GROUP operation-attributes-tag ATTR charset attributes-charset utf-8 ATTR language attributes-natural-language en "
                            f"ATTR uri printer-uri $uri ATTR integer job-id {job} ATTR name requesting-user-name $user }}")
        told = subprocess.run(["ipptool", "-tv", self.url, question], capture_output=True, text=True).stdout
        return re.search(r"job-state \(enum\) = (\S+)", told).group(1)

    def stop(self) -> None:
        for process in reversed(self.processes):
            end(process)
        self.log.close()


class LateLine:
    """A line to what listens at another port here. Once the words went out over a connection, what comes back on it waits for `through`."""

    def __init__(self, to: int, words: bytes):
        self.to, self.words = to, words
        self.asked, self.through = threading.Event(), threading.Event()
        self.answered = b""  # what came back on connections over which the words went
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.open = [self.listener]
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            try:
                near = self.listener.accept()[0]
            except OSError:  # stopped
                return
            far, held = socket.create_connection(("127.0.0.1", self.to)), threading.Event()
            self.open += [near, far]
            for work, *ends in ((self._ask, near, far, held), (self._answer, far, near, held)):
                threading.Thread(target=self._until_closed, args=(work, *ends), daemon=True).start()

    @staticmethod
    def _until_closed(work, source: socket.socket, sink: socket.socket, held: threading.Event) -> None:
        try:
            work(source, sink, held)
            sink.shutdown(socket.SHUT_WR)
        except (OSError, ValueError):  # select says the latter of a closed socket
            pass

    def _ask(self, near: socket.socket, far: socket.socket, held: threading.Event) -> None:
        said = b""
        while data := near.recv(65536):
            said += data
            if self.words in said:
                held.set()  # before it goes on, so that no answer overtakes
            far.sendall(data)
            if held.is_set():
                self.asked.set()

    def _answer(self, far: socket.socket, near: socket.socket, held: threading.Event) -> None:
        # An answer comes in several pieces: all are taken in, also while none may go on.
        kept = b""
        while True:
            if select.select([far], [], [], 0.05)[0]:
                if not (data := far.recv(65536)):
                    break
                kept += data
                if held.is_set():
                    self.answered += data
            if kept and (self.through.is_set() or not held.is_set()):
                near.sendall(kept)
                kept = b""
        if kept:
            self.through.wait()
            near.sendall(kept)

    def stop(self) -> None:
        self.through.set()
        for one in self.open:
            one.close()


class OctoPrint:
    KEY = "0123456789ABCDEF0123456789ABCDEF"

    def __init__(self, folder: pathlib.Path, port: int):
        folder.mkdir(parents=True)
        self.folder, self.url = folder, f"http://127.0.0.1:{port}"
        (folder / "config.yaml").write_text(f"""
api: {{key: {self.KEY}}}
server: {{firstRun: false, onlineCheck: {{enabled: false}}, pluginBlacklist: {{enabled: false}}}}
plugins:
  virtual_printer: {{enabled: true}}
  _disabled: [softwareupdate, announcements, tracking, discovery, backup]
serial: {{autoconnect: true, port: VIRTUAL, baudrate: 0}}
""")
        self.log = (folder / "out.log").open("w")
        self.process = subprocess.Popen([PEERS / "bin/octoprint", "serve", "--iknowwhatimdoing", "--basedir", folder, "--host", "127.0.0.1", "--port", str(port)],
                                        stdout=self.log, stderr=self.log)
        wait_until(lambda: self.get("/api/connection").get("current", {}).get("state") == "Operational", 60, "OctoPrint's virtual printer")

    def get(self, path: str) -> dict:
        try:
            with urllib.request.urlopen(urllib.request.Request(self.url + path, headers={"X-Api-Key": self.KEY}), timeout=5) as answer:
                return json.load(answer)
        except (OSError, http.client.HTTPException):
            return {}

    def stop(self) -> None:
        end(self.process)
        self.log.close()


class MeerK40t:
    """Its console, with a command that makes it listen."""

    def __init__(self, folder: pathlib.Path, command: str):
        folder.mkdir(parents=True)
        self.process = subprocess.Popen([PEERS / "bin/meerk40t", "-z", "-X", "-A", "-c", "-e", command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        env={**os.environ, "HOME": str(folder)}, text=True, errors="replace")
        self.said: queue.Queue[str] = queue.Queue()
        self.lines: list[str] = []
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        for line in self.process.stdout:
            self.lines.append(line)

    def wait_for(self, words: str) -> None:
        wait_until(lambda: any(words in line for line in self.lines), 40, f"MeerK40t's \"{words}\"")

    def stop(self) -> None:
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            stream.close()
