#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Uploads to a real OctoPrint with its virtual printer, and slicing with a real PrusaSlicer.
Usage: machine_upload_test.py PROGRAM VIRTUAL_GRBL PEERS"""
import concurrent.futures
import hashlib
import http.server
import io
import json
import pathlib
import re
import select
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import machine_peers as peers
from machine_driven_test import MachineSocket
from worker import Worker

SLOW = b"M105\n" + b"G4 P400\nM105\n" * 200


class WorkerCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.data = cls.folder / "data"
        cls.worker = Worker(peers.PROGRAM, cls.data)

    @classmethod
    def tearDownClass(cls):
        cls.worker.stop()
        cls.temporary.cleanup()

    def upload(self, machine: str, content: bytes, **order):
        status, answer = self.worker.json("POST", f"/api/machines/{machine}/upload", {"sha256": self.worker.put_blob(content), **order})
        if status != 202:
            return status, answer
        return status, peers.wait_until(lambda: (s := self.worker.json("GET", f"/api/machines/{machine}/jobs/{answer['id']}")[1])["state"] in ("done", "failed", "cancelled") and s, 60)


class OctoPrint(WorkerCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.octoprint = peers.OctoPrint(cls.folder / "octoprint", 5055)
        (cls.folder / "key").write_text(cls.octoprint.KEY + "\n")
        cls.id = peers.add_machine(cls.data, "Mould printer", cls.octoprint.url, "--kind", "octoprint", "--api-key-file", str(cls.folder / "key"))

    @classmethod
    def tearDownClass(cls):
        cls.octoprint.stop()
        super().tearDownClass()

    def test_its_state_is_read_and_its_key_is_kept(self):
        status, detail = self.worker.json("GET", f"/api/machines/{self.id}")
        self.assertEqual(status, 200, detail)
        self.assertEqual((detail["kind"], detail["state"]), ("octoprint", "ready"))
        self.assertTrue(detail["software"].startswith("OctoPrint 1."))
        self.assertNotIn(self.octoprint.KEY, json.dumps([detail, self.worker.json("GET", "/api/machines")[1]]))
        self.assertEqual((self.data / "machines.json").stat().st_mode & 0o077, 0)

    def test_an_upload_arrives(self):
        content = b"; 1.5 MB of it\n" + b"G1 X1 Y1 F600\n" * 110_000
        status, ended = self.upload(self.id, content, file_name="../odd name/mould (1).gcode")
        self.assertEqual((status, ended["state"]), (202, "done"), ended)
        self.assertEqual(ended["result"], {"file_name": "mould__1_.gcode", "printing": False})
        self.assertEqual((self.octoprint.folder / "uploads/mould__1_.gcode").read_bytes(), content)
        listed = self.octoprint.get("/api/files/local/mould__1_.gcode")
        self.assertEqual(listed["hash"], hashlib.sha1(content).hexdigest())

    def test_a_print_starts_only_when_confirmed_and_stops(self):
        status, answer = self.upload(self.id, SLOW, file_name="slow.gcode", print=True)
        self.assertEqual((status, answer["error"]["where"]), (422, "confirmed"))
        status, ended = self.upload(self.id, SLOW, file_name="slow.gcode", print=True, confirmed=True)
        self.assertEqual(ended["state"], "done", ended)
        self.assertTrue(ended["result"]["printing"])
        peers.wait_until(lambda: self.worker.json("GET", f"/api/machines/{self.id}")[1]["state"] == "printing", 20, "printing")
        # The file that prints cannot be replaced, and that is said.
        status, ended = self.upload(self.id, SLOW + b"M105\n", file_name="slow.gcode", print=True, confirmed=True)
        self.assertEqual(ended["state"], "failed", ended)
        self.assertIn("cannot take the file now", ended["error"]["message"])
        self.assertEqual(self.worker.json("POST", f"/api/machines/{self.id}/stop", {})[0], 200)
        peers.wait_until(lambda: self.octoprint.get("/api/job").get("state") == "Operational", 30, "the stop")

    def test_a_wrong_key_and_a_wrong_kind_are_said(self):
        (self.folder / "wrong").write_text("F" * 32)
        wrong = peers.add_machine(self.data, "Wrong", self.octoprint.url.replace("127.0.0.1", "localhost"), "--kind", "octoprint", "--api-key-file", str(self.folder / "wrong"))
        status, ended = self.upload(wrong, b"G28\n", file_name="a.gcode")
        self.assertEqual(ended["state"], "failed", ended)
        self.assertIn("does not accept the key", ended["error"]["message"])
        peers.formwright("remove", "Wrong", data=self.data)
        other = peers.add_machine(self.data, "Other", self.octoprint.url, "--kind", "moonraker")
        status, ended = self.upload(other, b"G28\n", file_name="a.gcode")
        self.assertEqual(ended["state"], "failed", ended)
        self.assertRegex(ended["error"]["message"], r"is no Moonraker|refused the file|does not accept the key")
        peers.formwright("remove", "Other", data=self.data)


class StrictMoonraker(http.server.BaseHTTPRequestHandler):
    """What Moonraker's documentation says of POST /server/files/upload, to the letter; no real Moonraker runs without a printer's firmware."""
    kept: dict[str, bytes] = {}
    started: list[str] = []
    cancels = 0
    protocol_version = "HTTP/1.1"

    def log_message(self, *words):
        pass

    def answer(self, status: int, message) -> None:
        body = json.dumps(message).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def do_POST(self):
        if self.headers["X-Api-Key"] != "moon":
            return self.answer(401, {"error": {"code": 401, "message": "Unauthorized"}})
        if self.path == "/printer/print/cancel":
            self.rfile.read(int(self.headers["Content-Length"]))
            StrictMoonraker.cancels += 1
            return self.answer(200, {"result": "ok"})
        boundary = re.fullmatch(r"multipart/form-data; boundary=(\S+)", self.headers["Content-Type"]).group(1).encode()
        body = self.rfile.read(int(self.headers["Content-Length"]))
        fields, name = {}, ""
        parts = body.split(b"--" + boundary)
        assert parts[0] == b"" and parts[-1] == b"--\r\n"
        for part in parts[1:-1]:
            head, content = part[2:-2].split(b"\r\n\r\n", 1)
            field = re.search(rb'name="([^"]*)"', head).group(1).decode()
            fields[field] = content
            if match := re.search(rb'filename="([^"]*)"', head):
                name = match.group(1).decode()
        if self.path != "/server/files/upload" or set(fields) - {"file", "root", "path", "checksum", "print"} or fields["root"] != b"gcodes":
            return self.answer(400, {"error": {"code": 400, "message": "Bad Request"}})
        if hashlib.sha256(fields["file"]).hexdigest() != fields["checksum"].decode():
            return self.answer(422, {"error": {"code": 422, "message": "File checksum mismatch"}})
        if fields["print"] not in (b"true", b"false"):
            return self.answer(400, {"error": {"code": 400, "message": "print"}})
        self.kept[name] = fields["file"]
        if fields["print"] == b"true":
            self.started.append(name)
        self.answer(201, {"item": {"path": name, "root": "gcodes", "size": len(fields["file"])}, "print_started": fields["print"] == b"true", "print_queued": False, "action": "create_file"})


class Moonraker(WorkerCase):
    def test_the_upload_is_as_its_documentation_says(self):
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), StrictMoonraker)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            (self.folder / "key").write_text("moon")
            machine = peers.add_machine(self.data, "Voron", f"http://127.0.0.1:{server.server_port}", "--kind", "moonraker", "--api-key-file", str(self.folder / "key"))
            content = bytes(range(256)) * 5000
            status, ended = self.upload(machine, content, file_name="part.gcode")
            self.assertEqual(ended["state"], "done", ended)
            self.assertEqual(StrictMoonraker.kept["part.gcode"], content)
            self.assertEqual(StrictMoonraker.started, [])
            status, ended = self.upload(machine, content, file_name="part.gcode", print=True, confirmed=True)
            self.assertEqual(ended["result"], {"file_name": "part.gcode", "printing": True})
            self.assertEqual(StrictMoonraker.started, ["part.gcode"])
        finally:
            server.shutdown()
            server.server_close()


class Silent(WorkerCase):
    """Machines that are asked and never answer, as those that are switched off: nothing that is urgent waits behind them."""

    def setUp(self):
        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), StrictMoonraker)
        threading.Thread(target=self.server.serve_forever, daemon=True).start()
        (self.folder / "key").write_text("moon")
        self.printing = peers.add_machine(self.data, "Voron", f"http://127.0.0.1:{self.server.server_port}", "--kind", "moonraker", "--api-key-file", str(self.folder / "key"))
        self.laser = peers.VirtualGrbl()
        self.laser_id = peers.add_machine(self.data, "Laser", f"serial:{self.laser.port}")
        self.silent = [socket.create_server(("127.0.0.1", 0)) for _ in range(8)]
        self.silent_ids = [peers.add_machine(self.data, f"Off {i}", f"http://127.0.0.1:{listener.getsockname()[1]}", "--kind", "octoprint" if i % 2 else "moonraker")
                           for i, listener in enumerate(self.silent)]

    def tearDown(self):
        self.server.shutdown()
        self.server.server_close()
        self.laser.stop()

    def within(self, seconds: float, work):
        start = time.monotonic()
        result = work()
        self.assertLess(time.monotonic() - start, seconds)
        return result

    def test_a_stop_and_an_opening_do_not_wait_behind_them(self):
        with concurrent.futures.ThreadPoolExecutor(len(self.silent)) as pages:
            states = [pages.submit(self.worker.json, "GET", f"/api/machines/{machine}") for machine in self.silent_ids]
            try:
                peers.wait_until(lambda: len(select.select(self.silent, [], [], 0)[0]) >= 4, 10, "the asking")
                self.assertEqual(self.within(5, lambda: self.worker.json("POST", f"/api/machines/{self.printing}/stop", {}))[0], 200)
                self.assertEqual(StrictMoonraker.cancels, 1)
                page = self.within(5, lambda: MachineSocket(self.worker, self.laser_id))
                self.assertEqual(self.within(5, lambda: page.ask(open={"controller": "grbl"})), {"done": 1})
                self.assertEqual(self.within(5, lambda: self.worker.json("GET", "/api/machines?search=again"))[0], 200)
                self.assertEqual(self.within(5, lambda: self.worker.json("GET", f"/api/machines/{self.laser_id}"))[0], 200)
                self.assertEqual(self.within(5, lambda: self.worker.json("GET", "/api/machines/log"))[0], 200)
                self.assertFalse(any(state.done() for state in states))  # they were silent all the while
            finally:
                for listener in self.silent:  # which hangs up on all that wait there
                    listener.close()
        self.assertEqual({state.result()[0] for state in states}, {502})


def cube_stl(size: float) -> bytes:
    corners = [(x, y, z) for z in (0, size) for y in (0, size) for x in (0, size)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return bytes(80) + struct.pack("<I", len(triangles)) + b"".join(struct.pack("<12fH", 0, 0, 0, *(v for i in t for v in corners[i]), 0) for t in triangles)


def cube_3mf(size: float, config: str) -> bytes:
    stl = cube_stl(size)
    points, faces = [], []
    for i in range(12):
        numbers = struct.unpack_from("<12f", stl, 84 + 50 * i)[3:]
        faces.append([])
        for p in (numbers[0:3], numbers[3:6], numbers[6:9]):
            if p not in points:
                points.append(p)
            faces[-1].append(points.index(p))
    mesh = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in points), "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("[Content_Types].xml", '<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
                         '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
        archive.writestr("_rels/.rels", '<?xml version="1.0" encoding="UTF-8"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
                         '<Relationship Target="/3D/3dmodel.model" Id="rel-1" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
        archive.writestr("3D/3dmodel.model", '<?xml version="1.0" encoding="UTF-8"?><model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:slic3rpe="http://schemas.slic3r.org/3mf/2017/06"><metadata name="slic3rpe:Version3mf">1</metadata><metadata name="Application">PrusaSlicer-2.5.0</metadata>'
                         f'<resources><object id="1" type="model"><mesh><vertices>{mesh[0]}</vertices><triangles>{mesh[1]}</triangles></mesh></object></resources><build><item objectid="1"/></build></model>')
        archive.writestr("Metadata/Slic3r_PE.config", config)
    return stream.getvalue()


class Slicing(WorkerCase):
    def slicer(self) -> str:
        return next(m["id"] for m in self.worker.json("GET", "/api/machines")[1] if m["kind"] == "slicer")

    def slice(self, content: bytes, **order):
        return self.worker.json("POST", f"/api/machines/{self.slicer()}/slice", {"sha256": self.worker.put_blob(content), **order})

    def test_a_cube_becomes_gcode_of_its_height(self):
        status, answer = self.slice(cube_stl(20))
        self.assertEqual(status, 200, answer)
        gcode = self.worker.request("GET", f"/api/blobs/{answer['sha256']}")[1].decode()
        heights = [float(z) for z in re.findall(r"^;Z:([\d.]+)$", gcode, re.M)] or [float(z) for z in re.findall(r"^G1 Z([\d.]+)", gcode, re.M)]
        self.assertAlmostEqual(max(h for h in heights if h <= 20.4), 20, delta=0.4)
        self.assertRegex(gcode, r"generated by PrusaSlicer")
        self.assertEqual(list(self.data.glob("slicing-*")), [])

    def test_no_program_that_a_file_brings_is_run(self):
        trap = self.folder / "trap.sh"
        trap.write_text(f"#!/bin/sh\ntouch {self.folder}/trapped\n")
        trap.chmod(0o755)
        # The trap is one: run the slicer's own way, it snaps.
        config = f"; post_process = {trap}\n; layer_height = 0.25\n"
        (self.folder / "bad.3mf").write_bytes(cube_3mf(15, config))
        subprocess.run(["prusa-slicer", "--export-gcode", "--post-process", str(trap), "--output", self.folder / "bad.gcode", self.folder / "bad.3mf"], capture_output=True, timeout=120)
        self.assertTrue((self.folder / "trapped").exists())
        (self.folder / "trapped").unlink()
        status, answer = self.slice(cube_3mf(15, config))
        self.assertEqual(status, 200, answer)
        self.assertFalse((self.folder / "trapped").exists())
        profiles = self.data / "slicer_profiles"
        profiles.mkdir()
        (profiles / "Fine.ini").write_text(f"post_process = {trap}\nlayer_height = 0.1\nfirst_layer_height = 0.1\n")
        status, answer = self.slice(cube_stl(18.3), profile="Fine")
        self.assertEqual(status, 200, answer)
        self.assertFalse((self.folder / "trapped").exists())
        gcode = self.worker.request("GET", f"/api/blobs/{answer['sha256']}")[1].decode()
        self.assertIn("; layer_height = 0.1", gcode)
        self.assertEqual(self.worker.json("GET", f"/api/machines/{self.slicer()}")[1]["profiles"], ["Fine"])
        for profile in ("../Fine", "/etc/passwd", "Other", "--help"):
            status, answer = self.slice(cube_stl(18.3), profile=profile)
            self.assertEqual((status, answer["error"]["where"]), (422, "profile"), answer)

    def test_what_cannot_be_sliced_is_said_and_a_slicing_is_cancelled(self):
        status, answer = self.slice(b"no model at all " * 10)
        self.assertEqual(status, 502, answer)
        self.assertIn("PrusaSlicer could not slice the model", answer["error"]["message"])
        self.assertEqual(self.slice(b"short")[0], 422)
        # A grid of towers keeps it at work for long.
        (self.data / "slicer_profiles").mkdir(exist_ok=True)
        (self.data / "slicer_profiles/Slow.ini").write_text("layer_height = 0.02\nfirst_layer_height = 0.02\nfill_density = 99%\nfill_pattern = gyroid\nmax_print_height = 400\nbed_shape = 0x0,400x0,400x400,0x400\n")
        status, answer = self.slice(cube_stl(150), profile="Slow", wait=False)
        self.assertEqual(status, 202, answer)
        path = f"/api/machines/{self.slicer()}/jobs/{answer['id']}"
        peers.wait_until(lambda: list(self.data.glob("slicing-*/model.stl")), 20, "the slicing")
        self.assertEqual(self.worker.json("POST", path + "/cancel")[0], 202)
        peers.wait_until(lambda: self.worker.json("GET", path)[1]["state"] == "cancelled", 10, "the cancel")
        self.assertEqual(list(self.data.glob("slicing-*")), [])
        self.assertEqual(subprocess.run(["pgrep", "-f", str(self.data)], capture_output=True, text=True).stdout.split(), [str(self.worker.process.pid)])


if __name__ == "__main__":
    unittest.main(verbosity=2)
