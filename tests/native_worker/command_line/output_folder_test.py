#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What stays in the output folder and what goes, whether a run succeeds, fails, is killed or finds no room. Usage: output_folder_test.py PROGRAM"""
import json
import os
import subprocess
import unittest

from command_line_case import PROGRAM, CommandLineCase, written


def square_svg(size_mm: float) -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" width="{size_mm}mm" height="{size_mm}mm" viewBox="0 0 {size_mm} {size_mm}"><rect x="1" y="1" width="{size_mm - 2}" height="{size_mm - 2}" fill="none" stroke="red"/></svg>'


class CommandLine(CommandLineCase):
    def test_earlier_results_survive_a_failure(self):
        out = self.folder / "out"
        self.assertEqual(self.run_program("import", "--sample", "pyramid", "--out", out, "--quiet").returncode, 0)
        before = {p.name: p.read_bytes() for p in out.iterdir()}
        self.assertEqual(self.run_program("import", "--mesh", self.folder / "absent.obj", "--out", out).returncode, 2)
        self.assertEqual({p.name: p.read_bytes() for p in out.iterdir()}, before)

    def test_a_job_that_does_not_fit_leaves_none_to_be_sent(self):
        out, drawing = self.folder / "out", self.folder / "drawing.svg"
        drawing.write_text(square_svg(50))
        words = ("laser-job", "--drawing", drawing, "--bed-x-mm", 100, "--bed-y-mm", 100, "--out", out, "--quiet")
        self.assertEqual(self.run_program(*words).returncode, 0)
        self.assertEqual(written(out), ["job.gcode", "report.json", "toolpath.json"])
        (out / "mine.gcode").write_text("G0 X1")
        for wrong, sentence in ((square_svg(150), "beyond the right edge of the bed"), ("<svg", "drawing")):
            self.assertEqual(self.run_program(*words, "--outputs", "job.gcode,job.rd").returncode, 0)
            self.assertEqual(written(out), ["job.gcode", "job.rd", "mine.gcode", "report.json"])
            drawing.write_text(wrong)
            self.expect_refused(sentence, *words)
            self.assertEqual(written(out), ["mine.gcode"])
            drawing.write_text(square_svg(50))
        # What the person made stays, also under a name of ours, until a run of ours writes it.
        (out / "preview.svg").write_text("mine")
        self.assertEqual(self.run_program(*words).returncode, 0)
        self.assertEqual((out / "preview.svg").read_text(), "mine")
        self.assertEqual(self.run_program(*words, "--outputs", "preview.svg").returncode, 0)
        self.assertEqual(written(out), ["mine.gcode", "preview.svg", "report.json"])
        # Another command's files stay, too.
        self.assertEqual(self.run_program("import", "--sample", "pyramid", "--out", out, "--quiet").returncode, 0)
        drawing.write_text(square_svg(150))
        self.assertEqual(self.run_program(*words).returncode, 2)
        self.assertEqual(written(out), ["mine.gcode", "model.ply", "report.json"])

    def test_outputs_of_an_earlier_version_go_with_a_job_that_does_not_fit(self):
        out, drawing = self.folder / "out", self.folder / "drawing.svg"
        out.mkdir()
        for name in ("report.json", "job.gcode", "notes.txt"):
            (out / name).write_text("old")
        drawing.write_text(square_svg(150))
        self.expect_refused("edge", "laser-job", "--drawing", drawing, "--bed-x-mm", 100, "--out", out, "--quiet")
        self.assertEqual(written(out), ["notes.txt"])

    def test_a_killed_run_leaves_nothing_for_long(self):
        out = self.folder / "out"
        (out / ".formwright-part-999999999").mkdir(parents=True)
        (out / ".formwright-part-999999999" / "job.gcode").write_text("G0")
        self.assertEqual(self.run_program("import", "--sample", "pyramid", "--out", out, "--quiet").returncode, 0)
        self.assertEqual(written(out), ["model.ply", "report.json"])

    def test_two_tools_are_two_jobs(self):
        out = self.folder / "out"
        words = ("mill-job", "--sample", "pyramid", "--sample-vertices", 500, "--width-mm", 30, "--pixel-mm", 0.5, "--out", out, "--quiet")
        self.assertEqual(self.run_program(*words, "--diameter-mm", 3, "--tool", "flat").returncode, 0)
        self.assertEqual(written(out), ["carved.ply", "job.gcode", "report.json", "toolpath.json"])
        self.assertEqual(json.loads((out / "report.json").read_text())["stages"], [])
        run = self.run_program(*words, "--diameter-mm", 2, "--outputs", "job.gcode,toolpath.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(written(out), ["job_1_rough.gcode", "job_2_finish.gcode", "report.json", "toolpath.json"])
        report, path = (json.loads((out / name).read_text()) for name in ("report.json", "toolpath.json"))
        self.assertEqual([stage["file"] for stage in report["stages"]], ["job_1_rough.gcode", "job_2_finish.gcode"])
        self.assertEqual([stage["file"] for stage in path["stages"]], ["job_1_rough.gcode", "job_2_finish.gcode"])
        self.assertEqual(report["line_count"], sum(stage["lines"] for stage in report["stages"]))
        self.assertIn("set z to 0", " ".join(report["notes"]))
        ends = [*(stage["first_path"] for stage in path["stages"][1:]), len(path["paths"])]
        for stage, told, end in zip(path["stages"], report["stages"], ends):
            lines = (out / stage["file"]).read_text().splitlines()
            self.assertEqual(len(lines), told["lines"])
            self.assertNotIn("M0", lines)
            moves = [line for line in lines if line.startswith(("G0 ", "G1 "))]
            self.assertTrue(moves[0].startswith("G0 Z"), moves[0])
            self.assertLess(lines.index("M5"), lines.index(moves[0]))
            self.assertEqual(lines[-3:], ["M5", "G0 X0 Y0", "M2"])
            # Lines of the preview are those of the stage's own file.
            for part in path["paths"][stage["first_path"]:end]:
                for i, line in enumerate(part["lines"][1:], 1):
                    self.assertTrue(lines[line - 1].startswith("G1" if part["kind"] == "work" else "G0"))
                    if "X" in lines[line - 1]:
                        self.assertAlmostEqual(float(lines[line - 1].split("X")[1].split()[0]), part["points_mm"][3 * i], places=3)

    def test_an_unwritable_folder_is_said(self):
        blocked = self.folder / "file"
        blocked.write_text("not a folder")
        run = self.run_program("import", "--sample", "pyramid", "--out", blocked / "out")
        self.assertEqual(run.returncode, 2)
        self.assertIn("cannot be made", run.stderr)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full here")
    def test_a_full_disk_is_said(self):
        out = self.folder / "out"
        out.mkdir()
        limited = subprocess.run(["bash", "-c", f"ulimit -f 4; trap '' XFSZ; exec {PROGRAM} import --sample bust --out {out} --quiet"], capture_output=True, text=True)
        self.assertEqual(limited.returncode, 2, limited.stderr)
        self.assertIn("make room", limited.stderr)
        self.assertEqual([p.name for p in out.iterdir()], [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
