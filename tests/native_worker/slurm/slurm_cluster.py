#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A Slurm cluster of two nodes on this computer, with ports, folders and authentication of its own. It runs as any user and leaves nothing behind.

To run a command in it: slurm_cluster.py COMMAND [WORD ...]"""
import getpass
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

NODES = ("n1", "n2")
# Requeued tasks wait until the old start's credential has expired (slurm.conf(5), AuthInfo), and a silent node counts as down after SlurmdTimeout.
CONFIGURATION = """ClusterName=formwright
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
AuthType=auth/none
CredType=cred/none
AuthInfo=cred_expire=5
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=3{scheduler}
SlurmdTimeout=4
MessageTimeout=3
SlurmctldTimeout=6
KillWait=2
ReturnToService=2
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs={cpus} State=UNKNOWN
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def program(name):
    """Daemons stand in sbin, which a person's PATH may lack."""
    return shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin:/usr/bin:/bin")


def missing_programs():
    return [name for name in ("slurmctld", "slurmd", "sbatch", "squeue", "scancel", "sinfo") if not program(name)]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def processes():
    return [int(name) for name in os.listdir("/proc") if name.isdigit()]


class SlurmCluster:
    """`cpus`: tasks that each node runs at once. Raises RuntimeError with Slurm's own log where it does not start."""

    def __init__(self, cpus=1, scheduler=""):
        self.temporary = tempfile.TemporaryDirectory(prefix="formwright-slurm-")
        self.folder = pathlib.Path(self.temporary.name)
        self.configuration = self.folder / "slurm.conf"
        (self.folder / "state").mkdir()
        self.configuration.write_text(CONFIGURATION.format(host=socket.gethostname(), ports=free_ports(3), folder=self.folder, user=getpass.getuser(), cpus=cpus, scheduler=scheduler))
        self.environment = {**{k: v for k, v in os.environ.items() if not k.startswith(("SLURM_", "SBATCH_", "SQUEUE_"))}, "SLURM_CONF": str(self.configuration)}
        self.daemons = {}
        try:
            self._start("slurmctld", "-D", "-c")
            for node in NODES:
                (self.folder / f"spool-{node}").mkdir()
                self._start("slurmd", "-D", "-N", node, name=node)
            self.wait_until(lambda: self.states() == {node: "idle" for node in NODES}, 40, "the nodes to be idle")
        except BaseException:
            self.close()
            raise

    def _start(self, daemon, *words, name=None):
        output = open(self.folder / f"{name or daemon}.out", "wb")
        self.daemons[name or daemon] = subprocess.Popen([program(daemon), *words], env=self.environment, stdin=subprocess.DEVNULL, stdout=output, stderr=output, start_new_session=True)
        output.close()

    def wait_until(self, condition, limit_s, what):
        end = time.monotonic() + limit_s
        while not condition():
            dead = [name for name, daemon in self.daemons.items() if daemon.poll() is not None]
            if time.monotonic() > end or dead:
                logs = "".join(f"\n--- {path.name}\n{path.read_text(errors='replace')[-1500:]}" for path in sorted(self.folder.glob("*.*")) if path.suffix in (".log", ".out"))
                raise RuntimeError(f"Slurm: waited {limit_s} s for {what}; ended: {dead}; nodes: {self.states()}{logs}")
            time.sleep(0.05)

    def run(self, name, *words):
        return subprocess.run([program(name), *words], env=self.environment, capture_output=True, text=True, timeout=60)

    def states(self):
        """Of the nodes, without the sign of a node that is silent."""
        lines = self.run("sinfo", "--noheader", "--Node", "--format=%N %t").stdout.split("\n")
        return {line.split()[0]: line.split()[1].rstrip("*") for line in lines if line.strip()}

    def queue(self):
        """State and node of each task that waits or runs."""
        lines = self.run("squeue", "--noheader", "--array", "--format=%T %N").stdout.split("\n")
        return [tuple(line.split()) for line in lines if line.strip()]

    def processes_of(self, node):
        """The node's daemon and steps, which hold its log open, and the tasks, which know their node."""
        log, found = str(self.folder / f"{node}.log"), []
        for process in processes():
            try:
                environment = pathlib.Path(f"/proc/{process}/environ").read_bytes().split(b"\0")
                held = {os.path.realpath(link) for link in pathlib.Path(f"/proc/{process}/fd").iterdir()}
            except OSError:
                continue
            ours = f"SLURM_CONF={self.configuration}".encode() in environment and f"SLURMD_NODENAME={node}".encode() in environment
            if ours or log in held:
                found.append(process)
        return found

    def kill_node(self, node):
        """As a power cut does: all at once."""
        for process in self.processes_of(node):
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.daemons.pop(node).wait()

    def close(self):
        self.run("scancel", "--user", getpass.getuser()) if self.daemons.get("slurmctld") and self.daemons["slurmctld"].poll() is None else None
        for node in NODES:
            if node in self.daemons:
                self.kill_node(node)
        for daemon in self.daemons.values():
            daemon.kill()
            daemon.wait()
        self.daemons = {}
        self.temporary.cleanup()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    with SlurmCluster() as cluster:
        sys.exit(subprocess.run(sys.argv[1:], env=cluster.environment).returncode)
