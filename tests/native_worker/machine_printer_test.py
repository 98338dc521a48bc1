#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Printing at true size, to a real IPP printer program: what it takes, what arrives, what is refused before paper is spent.
Usage: machine_printer_test.py PROGRAM VIRTUAL_GRBL PEERS"""
import io
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import machine_peers as peers
from worker import Worker


def pdf_of(objects: list[str]) -> bytes:
    """A PDF of these objects, counted from 1; the first is the catalogue."""
    text, offsets = "%PDF-1.4\n", []
    for number, content in enumerate(objects, 1):
        offsets.append(len(text))
        text += f"{number} 0 obj\n{content}\nendobj\n"
    start = len(text)
    text += f"xref\n0 {len(objects) + 1}\n0000000000 65535 f \n" + "".join(f"{o:010} 00000 n \n" for o in offsets)
    return (text + f"trailer\n<</Size {len(objects) + 1}/Root 1 0 R>>\nstartxref\n{start}\n%%EOF\n").encode()


def page(width_mm: float, height_mm: float, pages: int = 1) -> bytes:
    """A red square of 40 mm, its corner 30 mm from the left and 20 mm from the bottom."""
    point = 72 / 25.4
    drawing = f"1 0 0 rg {30 * point:.4f} {20 * point:.4f} {40 * point:.4f} {40 * point:.4f} re f"
    kids = " ".join(f"{4 + i} 0 R" for i in range(pages))
    return pdf_of(["<</Type/Catalog/Pages 2 0 R>>", f"<</Type/Pages/Kids[{kids}]/Count {pages}>>", f"<</Length {len(drawing)}>>\nstream\n{drawing}\nendstream"]
                  + [f"<</Type/Page/Parent 2 0 R/MediaBox[0 0 {width_mm * point:.4f} {height_mm * point:.4f}]/Contents 3 0 R>>"] * pages)


def red_box_mm(document: bytes, folder: pathlib.Path):
    """left, right, bottom, top of what is red on the first page, by another program's rendering."""
    (folder / "page.pdf").write_bytes(document)
    subprocess.run(["pdftoppm", "-r", "254", "-singlefile", folder / "page.pdf", folder / "page"], check=True)
    magic, size, most, pixels = (folder / "page.ppm").read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    columns, rows = [], []
    for y in range(height):
        row = pixels[3 * width * y:3 * width * (y + 1)]
        first = row.find(b"\xff\x00\x00")
        if first >= 0:
            rows.append(y)
            columns += [first / 3, row.rfind(b"\xff\x00\x00") / 3 + 1]
    return min(columns) / 10, max(columns) / 10, (height - max(rows) - 1) / 10, (height - min(rows)) / 10


class Printing(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.data = cls.folder / "data"
        # The page "ready" in it is Letter; A4 is fed by hand.
        cls.printer = peers.Printer(cls.folder / "printer", 8631)
        cls.id = peers.add_machine(cls.data, "Studio", cls.printer.url)
        cls.worker = Worker(peers.PROGRAM, cls.data)

    @classmethod
    def tearDownClass(cls):
        cls.worker.stop()
        cls.printer.stop()
        cls.temporary.cleanup()

    def order(self, document: bytes, machine: str | None = None, **order):
        status, answer = self.worker.json("POST", f"/api/machines/{machine or self.id}/print", {"sha256": self.worker.put_blob(document), **order})
        self.assertEqual(status, 202, answer)
        return answer["id"]

    def wait(self, job: str, machine: str | None = None):
        def ended():
            state = self.worker.json("GET", f"/api/machines/{machine or self.id}/jobs/{job}")[1]
            self.seen.add(state["state"])
            return state if state["state"] in ("done", "failed", "cancelled") else None
        self.seen: set[str] = set()
        return peers.wait_until(ended, 90, "the end of the print")

    def refused(self, where: str, words: str, document: bytes, **order):
        printed = len(self.printer.jobs())
        ended = self.wait(self.order(document, **order))
        self.assertEqual(ended["state"], "failed", ended)
        self.assertEqual(ended["error"]["where"], where)
        self.assertIn(words, ended["error"]["message"])
        self.assertTrue(ended["error"]["message"].endswith("."))
        self.assertEqual(len(self.printer.jobs()), printed)

    def test_what_it_takes_is_read(self):
        status, detail = self.worker.json("GET", f"/api/machines/{self.id}")
        self.assertEqual(status, 200, detail)
        self.assertEqual((detail["name"], detail["kind"], detail["state"]), ("Studio", "printer", "idle"))
        self.assertIn("application/pdf", detail["formats"])
        a4 = next(m for m in detail["media"] if m["label"] == "A4")
        self.assertEqual((a4["name"], a4["width_mm"], a4["height_mm"], a4["loaded"], a4["by_hand"]), ("iso_a4_210x297mm", 210, 297, False, True))
        # Compared with what another program of the same printer's makers reads.
        told = subprocess.run(["ipptool", "-tv", self.printer.url, "get-printer-attributes.test"], capture_output=True, text=True).stdout
        margins = re.search(r"x-dimension=21000 y-dimension=29700\} media-size-name=iso_a4_210x297mm media-bottom-margin=(\d+) media-left-margin=(\d+) media-right-margin=(\d+) media-top-margin=(\d+)", told)
        self.assertEqual([round(100 * a4["margins_mm"][side]) for side in ("bottom", "left", "right", "top")], [int(n) for n in margins.groups()])
        letter = next(m for m in detail["media"] if m["label"] == "Letter")
        self.assertTrue(letter["loaded"])
        self.assertEqual((letter["width_mm"], letter["height_mm"]), (215.9, 279.4))

    def test_a_page_arrives_at_true_size(self):
        document = page(210, 297)
        before = len(self.printer.jobs())
        ended = self.wait(self.order(document, media="A4", copies=2, quality="high"))
        self.assertEqual(ended["state"], "done", ended)
        self.assertTrue(any("manual feed" in note for note in ended["result"]["notes"]))
        jobs = self.printer.jobs()
        self.assertEqual(len(jobs), before + 1)
        received, attributes = jobs[-1]
        self.assertEqual(received, document)
        media = attributes["IPP_MEDIA_COL"]
        self.assertIn("x-dimension=21000", media)
        self.assertIn("y-dimension=29700", media)
        self.assertEqual(attributes["IPP_PRINT_SCALING"], "none")
        self.assertEqual(attributes["IPP_COPIES"], "2")
        self.assertEqual(attributes["IPP_PRINT_QUALITY"], "high")
        left, right, bottom, top = red_box_mm(received, self.folder)
        for found, wanted in ((left, 30), (right, 70), (bottom, 20), (top, 60)):
            self.assertAlmostEqual(found, wanted, delta=0.15)

    def test_mirrored_is_mirrored_in_the_document(self):
        ended = self.wait(self.order(page(215.9, 279.4, pages=2), media="na_letter_8.5x11in", mirrored=True))
        self.assertEqual(ended["state"], "done", ended)
        received, _ = self.printer.jobs()[-1]
        left, right, bottom, top = red_box_mm(received, self.folder)
        for found, wanted in ((left, 215.9 - 70), (right, 215.9 - 30), (bottom, 20), (top, 60)):
            self.assertAlmostEqual(found, wanted, delta=0.15)
        info = subprocess.run(["pdfinfo", self.folder / "page.pdf"], capture_output=True, text=True, check=True).stdout
        self.assertIn("Pages:           2", info)
        self.assertIn("612 x 792 pts (letter)", info)

    def test_a_picture_with_a_density_is_printed_pixel_for_pixel(self):
        from PIL import Image
        picture = Image.new("RGB", (600, 400), "white")
        picture.putpixel((17, 33), (1, 2, 3))
        stream = io.BytesIO()
        picture.save(stream, "PNG", dpi=(300, 300))
        ended = self.wait(self.order(stream.getvalue(), media="Letter"))
        self.assertEqual(ended["state"], "done", ended)
        received, attributes = self.printer.jobs()[-1]
        with Image.open(io.BytesIO(received)) as back:
            self.assertEqual((back.size, back.getpixel((17, 33))), ((600, 400), (1, 2, 3)))
        picture.save(stream := io.BytesIO(), "PNG")
        self.refused("sha256", "pixels", stream.getvalue(), media="Letter")

    def test_what_would_go_wrong_is_refused_before(self):
        self.refused("media", "297.0 mm, the sheet Letter is 215.9 x 279.4 mm", page(210, 297), media="Letter")
        self.refused("media", "does not take A3", page(297, 420), media="A3")
        self.refused("copies", "1 to 999", page(210, 297), media="A4", copies=1000)
        self.refused("quality", "draft, normal or high", page(210, 297), media="A4", quality="fine")
        self.refused("sha256", "Only PDF, PNG and PWG raster", b"%!PS-Adobe\n", media="A4")
        self.refused("sha256", "cannot be read", b"%PDF-1.4\nnonsense", media="A4")
        # What is not even an order is refused at once.
        for order, where in (({"media": "A4"}, "sha256"), ({"sha256": "0" * 64, "media": "A4"}, "sha256"), ({"sha256": "../../etc/passwd", "media": "A4"}, "sha256"),
                             ({"sha256": "0" * 64, "media": 4}, "media"), ({"sha256": "0" * 64, "uri": "ipp://elsewhere"}, "uri"), ({"sha256": "0" * 64, "copies": 0}, "copies")):
            status, answer = self.worker.json("POST", f"/api/machines/{self.id}/print", order)
            self.assertEqual((status, answer["error"]["where"]), (422, where), answer)

    def test_a_busy_printer_is_asked_again(self):
        before = len(self.printer.jobs())
        slow = self.printer.spool / "slow"  # the first takes as long as the second needs to be turned away
        slow.touch()
        self.addCleanup(slow.unlink, missing_ok=True)
        jobs = [self.order(page(215.9, 279.4), media="Letter") for _ in range(2)]
        states = lambda: [self.worker.json("GET", f"/api/machines/{self.id}/jobs/{job}")[1]["state"] for job in jobs]  # noqa: E731
        peers.wait_until(lambda: "waiting" in states(), 40, "waiting")
        slow.unlink()
        for job in jobs:
            ended = self.wait(job)
            self.assertEqual(ended["state"], "done", ended)
        self.assertEqual(len(self.printer.jobs()), before + 2)

    def test_a_print_is_taken_back(self):
        job = self.order(page(215.9, 279.4), media="Letter")
        peers.wait_until(lambda: self.worker.json("GET", f"/api/machines/{self.id}/jobs/{job}")[1]["state"] == "printing", 40, "printing")
        self.assertEqual(self.worker.json("POST", f"/api/machines/{self.id}/jobs/{job}/cancel")[0], 202)
        self.assertEqual(self.wait(job)["state"], "cancelled")
        told = peers.wait_until(lambda: re.search(r"Cancel-Job", (self.printer.folder / "printer.log").read_text()), 10, "the printer's cancel")
        self.assertTrue(told)

    def restart_worker(self, kill: bool) -> None:
        if kill:
            self.worker.process.kill()
            self.worker.process.wait()
            self.worker.process.stdout.close()
        else:
            self.worker.stop()
        type(self).worker = Worker(peers.PROGRAM, self.data)

    def test_a_print_goes_on_without_the_worker_and_is_shown_by_the_next(self):
        for kill in (True, False):
            slow = self.printer.spool / "slow"
            slow.touch()
            self.addCleanup(slow.unlink, missing_ok=True)
            before = len(self.printer.jobs())
            job = self.order(page(215.9, 279.4), media="Letter", title="Kept")
            peers.wait_until(lambda: self.worker.json("GET", f"/api/machines/{self.id}/jobs/{job}")[1]["state"] == "printing", 40, "printing")
            peers.wait_until(lambda: json.loads((self.data / "prints" / f"{job}.json").read_text())["there"], 10, "its number")
            self.restart_worker(kill)
            status, shown = self.worker.json("GET", f"/api/machines/{self.id}/jobs/{job}")
            self.assertEqual((status, shown["kind"]), (200, "print"))
            self.assertNotIn(shown["state"], ("done", "failed", "cancelled"), shown)
            slow.unlink()
            ended = self.wait(job)
            self.assertEqual(ended["state"], "done", ended)
            self.assertEqual(len(self.printer.jobs()), before + 1)
            self.restart_worker(kill)
            # A worker that was killed before it had kept the end asks the printer again.
            self.assertEqual(self.wait(job)["result"], ended["result"])
        # One that the printer never had is not claimed to print.
        kept = json.loads((self.data / "prints" / f"{job}.json").read_text())
        lost = {**kept, "id": "a" * 32, "state": "sending", "there": None}
        lost.pop("result")
        (self.data / "prints" / f"{'a' * 32}.json").write_text(json.dumps(lost))
        (self.data / "prints" / f"{'b' * 32}.json").write_text('{"id": "b')
        self.restart_worker(True)
        ended = self.worker.json("GET", f"/api/machines/{self.id}/jobs/{'a' * 32}")[1]
        self.assertEqual(ended["state"], "failed", ended)
        self.assertIn("see whether it came through before sending it again", ended["error"]["message"])
        self.assertEqual(self.worker.json("GET", f"/api/machines/{self.id}/jobs/{'b' * 32}")[0], 404)

    def cancelled_while_taken_in(self, name: str):
        """The line, the machine at its end and the job: sent whole, not answered, cancelled."""
        line = peers.LateLine(8631, b"%%EOF")
        self.addCleanup(line.stop)
        machine = peers.add_machine(self.data, name, f"ipp://localhost:{line.port}/ipp/print")
        self.addCleanup(peers.formwright, "remove", name, data=self.data)
        job = self.order(page(215.9, 279.4), machine, media="Letter")
        self.assertTrue(line.asked.wait(40))
        self.assertEqual(self.worker.json("POST", f"/api/machines/{machine}/jobs/{job}/cancel")[0], 202)
        return line, machine, job

    def test_a_print_that_is_cancelled_while_the_printer_takes_it_in_is_taken_back(self):
        def number_on(line) -> int:
            found = re.search(rb"job-id\x00\x04(.{4})", line.answered, re.S)
            return int.from_bytes(found.group(1), "big") if found else 0
        never, silent, lost = self.cancelled_while_taken_in("Silent")
        start = time.monotonic()
        # Its number does not arrive here: nobody can take that one back.
        peers.wait_until(lambda: number_on(never) and self.printer.state_of(number_on(never)) == "completed", 60, "its sheet")
        slow = self.printer.spool / "slow"
        slow.touch()
        self.addCleanup(slow.unlink, missing_ok=True)
        line, late, job = self.cancelled_while_taken_in("Late")
        time.sleep(1.5)  # cancels are looked for twice a second
        self.assertEqual(self.worker.json("GET", f"/api/machines/{late}/jobs/{job}")[1]["state"], "sending")
        line.through.set()
        self.assertEqual(self.wait(job, late)["state"], "cancelled")
        slow.unlink()
        peers.wait_until(lambda: self.printer.state_of(number_on(line)) == "canceled", 10, "the printer's cancel")
        # One that never answers is not waited for for ever, and it is not claimed that nothing comes out.
        ended = self.wait(lost, silent)
        self.assertLess(time.monotonic() - start, 100)  # 30 s of silence; the rest is a busy machine's
        self.assertEqual(ended["state"], "cancelled")
        self.assertIn("check whether its sheets come out", ended["error"]["message"])

    def test_one_that_is_not_there_is_said(self):
        off = peers.add_machine(self.data, "Off", "ipp://localhost:8999/ipp/print")
        status, answer = self.worker.json("GET", f"/api/machines/{off}")
        self.assertEqual(status, 502)
        self.assertRegex(answer["error"]["message"], r"Off does not answer at .* switched on")
        silent = subprocess.Popen([sys.executable, "-c", "import socket,time\ns=socket.create_server(('127.0.0.1',8998))\nprint(1,flush=True)\nc=s.accept()[0]\ntime.sleep(0.5)\nc.close()\ntime.sleep(30)"], stdout=subprocess.PIPE)
        try:
            silent.stdout.readline()
            broken = peers.add_machine(self.data, "Broken", "ipp://127.0.0.1:8998/ipp/print")
            status, answer = self.worker.json("GET", f"/api/machines/{broken}")
            self.assertEqual(status, 502)
            self.assertIn("Broken", answer["error"]["message"])
        finally:
            silent.kill()
            silent.wait()
            silent.stdout.close()
        for name in ("Off", "Broken"):
            self.assertEqual(peers.formwright("remove", name, data=self.data).returncode, 0)
        self.assertEqual(self.worker.json("GET", f"/api/machines/{off}")[0], 404)

    def test_the_command_line_prints_too(self):
        file = self.folder / "letter.pdf"
        file.write_bytes(page(215.9, 279.4))
        run = peers.formwright("print", "--machine", "studio", "--file", file, "--media", "letter", data=self.data)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(self.printer.jobs()[-1][0], file.read_bytes())
        run = peers.formwright("print", "--machine", "studio", "--file", file, "--media", "A4", data=self.data)
        self.assertEqual(run.returncode, 2)
        self.assertIn("nothing is scaled", run.stderr)
        entries = [json.loads(line) for log in (self.data / "machine_log").glob("*.jsonl") for line in log.read_text().splitlines()]
        self.assertTrue(any(e["event"] == "task" and e["state"] == "done" and e["name"] == "Studio" for e in entries))
        self.assertTrue(any(e["event"] == "task" and e["state"] == "failed" for e in entries))
        status, log = self.worker.json("GET", "/api/machines/log?limit=5")
        self.assertEqual((status, len(log)), (200, 5))
        self.assertEqual(log, sorted(log, key=lambda e: -e["unix_s"]))

    def test_one_that_announces_itself_is_found(self):
        run = subprocess.run([peers.PROGRAM, "machine", "list", "--json", "--data", self.folder / "other"], capture_output=True, text=True, timeout=60, env=self.printer.environment)
        self.assertEqual(run.returncode, 0, run.stderr)
        found = [m for m in json.loads(run.stdout) if m["kind"] == "printer"]
        self.assertEqual([m["name"] for m in found], ["Studio"])
        self.assertFalse(found[0]["registered"])
        file = self.folder / "found.pdf"
        file.write_bytes(page(215.9, 279.4))
        run = subprocess.run([peers.PROGRAM, "machine", "print", "--data", self.folder / "other", "--machine", found[0]["id"], "--file", file, "--media", "Letter"],
                             capture_output=True, text=True, timeout=120, env=self.printer.environment)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(self.printer.jobs()[-1][0], file.read_bytes())


if __name__ == "__main__":
    unittest.main(verbosity=2)
