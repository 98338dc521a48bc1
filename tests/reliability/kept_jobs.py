# SPDX-License-Identifier: GPL-3.0-or-later
"""Small jobs whose outputs are known, and what may lie in a worker's data folder once they are done."""
import http.client
import json
import pathlib
import re
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "native_worker"))
from worker import Worker

TETRAHEDRON = b"v 0 0 0\nv 40 0 0\nv 0 40 0\nv 0 0 40\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
DONE = ("done", "failed", "cancelled")
NO_ANSWER = (ConnectionError, http.client.HTTPException, TimeoutError, OSError)


def job_number(number: int, blob: str) -> dict:
    """Each another, from a few milliseconds to a few tenths of a second. A relief whose model and viewpoint an earlier job in the same solver process had
    starts from that job's solution and ends a rounding error beside the one of a fresh process; so no two reliefs have the same viewpoint."""
    kind = number % 6
    if kind == 0:
        return {"operation": "import", "inputs": {"mesh": {"sha256": blob, "file_name": "tetrahedron.obj"}}}
    if kind == 1:
        return {"operation": "import", "inputs": {"mesh": {"sample": "pyramid", "vertices": 500}}}
    if kind == 2:
        return {"operation": "import", "inputs": {"mesh": {"sample": "bust", "vertices": 12000}}}
    return {"operation": "relief", "parameters": {"thickness_mm": kind, "distance_mm": 300 + number},
            "inputs": {"mesh": {"sample": "pyramid", "vertices": (600, 1500, 4000)[kind - 3]}}}


def outputs_of(worker: Worker, job: str, detail: dict) -> dict[str, bytes]:
    outputs = {}
    for name in detail["result"]["outputs"]:
        status, body, _ = worker.request("GET", f"/api/jobs/{job}/outputs/{name}")
        assert status == 200, (job, name, status, body)
        outputs[name] = body
    return outputs


def undisturbed(program: str, data: pathlib.Path, numbers: list[int]) -> dict[int, dict[str, bytes]]:
    """What the jobs of these numbers give where nothing goes wrong."""
    worker = Worker(program, data)
    try:
        blob = worker.put_blob(TETRAHEDRON)
        expected = {}
        for number in numbers:
            job = worker.post_job(**job_number(number, blob))
            detail = worker.wait(job)
            assert detail["state"] == "done", detail
            expected[number] = outputs_of(worker, job, detail)
        return expected
    finally:
        worker.stop()


def states(worker: Worker, accepted: dict[str, int]) -> dict[str, str]:
    """Of those that are listed, by id."""
    listed = worker.json("GET", "/api/jobs?limit=500")[1]
    return {job["id"]: job["state"] for job in listed if job["id"] in accepted}


def wait_for_all(worker: Worker, accepted: dict[str, int], seconds: float) -> bool:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = states(worker, accepted)
        if len(found) < len(accepted) or all(state in DONE for state in found.values()):
            return True
        time.sleep(0.02)
    return False


def left_over(data: pathlib.Path) -> list[str]:
    """What lies in a data folder and belongs to no blob, no job and no kept simulation."""
    found = []
    for path in sorted(data.rglob("*")):
        name = str(path.relative_to(data))
        if name in ("blobs", "jobs", "uploads", "results", "lock", "solver_lock", "machines.lock", "machines.json"):
            continue
        if re.fullmatch(r"blobs/[0-9a-f]{64}|results/[0-9a-f]{64}", name):
            continue
        if match := re.fullmatch(r"jobs/([0-9a-f]{32})(/outputs(?:/(.+))?|/job\.json|/result\.json)?", name):
            folder = data / "jobs" / match.group(1)
            job = json.loads((folder / "job.json").read_text()) if (folder / "job.json").exists() else {}
            done = job.get("state") == "done"
            listed = json.loads((folder / "result.json").read_text()).get("outputs", {}) if done else {}
            if job and (not match.group(3) or match.group(3) in listed) and (done or not (match.group(2) or "").startswith("/outputs")):
                continue
        found.append(name)
    return found


class Figures:
    """How the accepted jobs came through: each is done with the right bytes, or counted as what else it is."""

    def __init__(self):
        self.accepted = self.done = self.equal = 0
        self.failures: list[str] = []

    def add(self, worker: Worker, accepted: dict[str, int], expected: dict[int, dict[str, bytes]], where: str) -> None:
        for job, number in accepted.items():
            self.accepted += 1
            status, detail = worker.json("GET", f"/api/jobs/{job}")
            if status != 200 or detail["state"] != "done":
                self.failures.append(f"{where}: job {job}: {status} {detail}")
                continue
            self.done += 1
            if outputs_of(worker, job, detail) == expected[number]:
                self.equal += 1
            else:
                self.failures.append(f"{where}: job {job} has other outputs")
