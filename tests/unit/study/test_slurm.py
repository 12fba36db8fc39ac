#!/usr/bin/python3
"""A sweep as a job array of a real Slurm that is started here: one task killed with SIGKILL, one with SIGTERM, both
submitted again as `missing` says; the table must be that of a serial run, and of GNU parallel and Snakemake where they are.

Usage: test_slurm.py ARGIL [SWEEP.json] [--keep FOLDER]
"""
import argparse
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CONFIG = """ClusterName=argil
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0,bf_interval=1
SlurmctldPort={port}
SlurmdPort={next_port}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ReturnToService=2
KillWait=10
MinJobAge=2
MaxArraySize=1001
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Slurm:
    """Daemons of our own in one folder; ends them when left."""

    def __init__(self, folder):
        self.folder, self.daemons = folder, []

    def __enter__(self):
        folder = self.folder
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        port = free_port()
        (folder / "slurm.conf").write_text(CONFIG.format(folder=folder, host=socket.gethostname().split(".")[0], port=port,
                                                         next_port=free_port(), cpus=os.cpu_count()))
        os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
        try:
            self.start_all(folder, key)
        except RuntimeError:
            self.__exit__()
            raise
        return self

    def start_all(self, folder, key):
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder}/munge.socket",
                   f"--pid-file={folder}/munge.pid", f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed")
        self.wait(lambda: (folder / "munge.socket").exists(), "munged")
        self.start("slurmctld", "-D", "-i")
        self.start("slurmd", "-D")
        self.wait(lambda: "idle" in self.ask("sinfo", "-h", "-o", "%T"), "slurmd")

    def __exit__(self, *_):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            try:
                daemon.wait(timeout=20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def start(self, *command):
        with open(self.folder / f"{command[0]}.out", "w") as log:
            self.daemons.append(subprocess.Popen(command, stdout=log, stderr=log))

    def ask(self, *command):
        return subprocess.run(command, capture_output=True, text=True).stdout

    def wait(self, condition, what, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            ended = [daemon.args[0] for daemon in self.daemons if daemon.poll() is not None]
            if ended or time.monotonic() > end:
                logs = "".join(f"--- {log.name}\n{log.read_text()[-1500:]}" for log in sorted(self.folder.glob("*.[lo][ou][gt]")))
                raise RuntimeError(f"Slurm is installed, but {' and '.join(ended) or what} did not come up; what its daemons said:\n{logs}")
            time.sleep(0.2)

    def submit(self, array, points, argil):
        done = subprocess.run(["sbatch", "--parsable", f"--array={array}", f"--output={self.folder}/task-%a.log",
                               f"--export=ALL,ARGIL={argil}", ROOT / "scripts" / "sweep.sbatch", points],
                              capture_output=True, text=True, check=True)
        return done.stdout.strip()

    def finish(self, job):
        while self.ask("squeue", "-h", "-j", job).strip():
            time.sleep(0.5)


def find_tasks(points):
    """Processes that run points of the array: index → number of the process."""
    tasks = {}
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if str(points).encode() in (process / "cmdline").read_bytes():
                index = [value for value in (process / "environ").read_bytes().split(b"\0") if value.startswith(b"SLURM_ARRAY_TASK_ID=")]
                tasks.update({int(value.split(b"=")[1]): int(process.name) for value in index})
        except OSError:
            pass  # has ended
    return tasks


def has_pending(process, number):
    status = Path(f"/proc/{process}/status").read_text()
    return int(status.split("ShdPnd:")[1].split()[0], 16) >> (number - 1) & 1


def signal_task(job, index, process, name):
    """Through Slurm. The task stands still until the signal is there, so that it cannot end before."""
    try:
        os.kill(process, signal.SIGSTOP)
        subprocess.run(["scancel", "--batch", f"--signal={name}", f"{job}_{index}"], capture_output=True)
        while not has_pending(process, getattr(signal, f"SIG{name}")):
            time.sleep(0.01)
        os.kill(process, signal.SIGCONT)
        while Path(f"/proc/{process}").exists():
            time.sleep(0.01)
    except OSError:
        pass  # is gone


def kill_two(slurm, job, points):
    """Sends SIGKILL to a task and SIGTERM to another, each while it writes its file, and waits until it is gone; one that
    was about to end does not count. Returns their indices."""
    results = points.with_suffix("")
    hit, tried = [], set()
    while len(hit) < 2:
        tasks = find_tasks(points)
        if not tasks and not slurm.ask("squeue", "-h", "-j", job).strip():
            raise RuntimeError("the array ended before two tasks could be killed")
        for index, process in tasks.items():
            if len(hit) == 2 or index in tried or not (results / f"{index:06d}.part.h5").exists():
                continue
            tried.add(index)
            name = "TERM" if hit else "KILL"
            signal_task(job, index, process, name)
            if not (results / f"{index:06d}.h5").exists():
                print(f"SIG{name} to task {index}", flush=True)
                hit.append(index)
        time.sleep(0.005)
    return hit


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("argil")
    parser.add_argument("sweep", nargs="?", default=ROOT / "scenarios" / "sweeps" / "dino.sweep.json")
    parser.add_argument("--keep", type=Path, help="folder for the table")
    options = parser.parse_args()
    missing = [name for name in ("munged", "slurmctld", "slurmd", "sbatch") if not shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin")]
    if missing or os.getuid() != 0:
        print(f"skipped: needs {' and '.join(missing) or 'root'} (packages slurm-wlm and munge)")
        return 77
    os.environ["PATH"] += ":/usr/sbin"
    argil = str(Path(options.argil).resolve())

    def sweep(*arguments):
        return subprocess.run([argil, "sweep", *map(str, arguments)], capture_output=True, text=True, check=True).stdout.strip()

    with tempfile.TemporaryDirectory() as temp:
        folder = Path(temp)
        points = folder / "points.jsonl"
        print(sweep("expand", options.sweep, "-o", points))
        count = len(points.read_text().splitlines())
        with Slurm(folder) as slurm:
            job = slurm.submit(sweep("missing", points), points, argil)
            hit = kill_two(slurm, job, points)
            slurm.finish(job)
            again = sweep("missing", points)
            print(f"missing after job {job}: {again}")
            spans = [span.split("-") for span in again.split(",")]
            if {n for span in spans for n in range(int(span[0]), int(span[-1]) + 1)} != set(hit):
                raise RuntimeError(f"tasks {hit} were killed")
            slurm.finish(slurm.submit(again, points, argil))
        print(sweep("collect", points, "-o", folder / "slurm"))
        if sweep("missing", points):
            raise RuntimeError("points are missing at the end")
        engines = {"serial": [argil, "sweep", "run", points, "--index", "0", "--block", str(count)]}
        if shutil.which("parallel"):
            engines["parallel"] = ["parallel", "--will-cite", "-j2", argil, "sweep", "run", points, "--index", "{}", ":::",
                                   *map(str, range(count))]
        if shutil.which("snakemake"):
            engines["Snakemake"] = ["snakemake", "--quiet", "all", "--snakefile", ROOT / "scripts" / "sweep.snakefile", "--cores", "2",
                                    "--directory", folder, "--config", f"points={points}"]
        named = {**os.environ, "PATH": f"{Path(argil).parent}:{os.environ['PATH']}"}  # as the Snakefile calls it
        for name, command in engines.items():
            shutil.rmtree(folder / "points")
            subprocess.run(command, check=True, env=named)
            sweep("collect", points, "-o", folder / name)
            for suffix in (".csv", ".h5"):
                if (folder / f"slurm{suffix}").read_bytes() != (folder / f"{name}{suffix}").read_bytes():
                    raise RuntimeError(f"the tables differ: {name}{suffix}")
        if options.keep:
            shutil.copy(folder / "slurm.csv", options.keep / "dino_sweep.csv")
        print(f"{count} points: the table of the job array is, byte for byte, that of {' and '.join(engines)} runs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
