"""A Slurm of one controller and three nodes on this machine, as packaged, while it is needed.

    with slurm.running(folder) as farm:
        farm.run("sbatch", ...)

Needs root, slurmctld, slurmd and slurm-client, but no munge and no service; ports and files are its own.
"""

import contextlib
import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

import cli

NODES = 3
CONFIG = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdTimeout=5
ReturnToService=2
MpiDefault=none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
{nodes}
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class Farm:
    def __init__(self, folder):
        self.folder = Path(folder).resolve()
        self.config = self.folder / "slurm.conf"
        self.env = {**os.environ, "SLURM_CONF": str(self.config),
                    "PATH": os.environ["PATH"] + ":/usr/sbin"}
        self.daemons = {}

    def start(self):
        (self.folder / "state").mkdir(parents=True)
        host = socket.gethostname().split(".")[0]
        ports = free_ports(NODES + 1)
        nodes = "\n".join(f"NodeName=n{i} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[i]} CPUs=1 "
                          "RealMemory=1000 State=UNKNOWN" for i in range(1, NODES + 1))
        self.config.write_text(CONFIG.format(host=host, port=ports[0], folder=self.folder, nodes=nodes),
                               encoding="utf-8")
        self.daemons["controller"] = self.daemon("slurmctld", "-D", "-i")
        for i in range(1, NODES + 1):
            self.start_node(f"n{i}")
        self.wait(lambda: self.run("sinfo", "-h", "-N", "-t", "idle", "-o", "%N").split().__len__() == NODES,
                  60, "the nodes to come up")

    def start_node(self, name):
        (self.folder / f"spool.{name}").mkdir(exist_ok=True)
        self.daemons[name] = self.daemon("slurmd", "-D", "-N", name)

    def daemon(self, *command):
        return subprocess.Popen(command, env=self.env, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL, start_new_session=True)

    def run(self, *command, check=True):
        done = subprocess.run(command, env=self.env, capture_output=True, text=True, check=False)
        assert not check or done.returncode == 0, (command, done.stdout, done.stderr)
        return done.stdout

    def wait(self, is_so, seconds, what):
        end = time.monotonic() + seconds
        while not is_so():
            if time.monotonic() > end:
                logs = "".join(path.read_text(errors="replace")[-2000:]
                               for path in sorted(self.folder.glob("*.log")))
                raise AssertionError(f"waited {seconds} s for {what}: {logs}")
            time.sleep(0.3)

    def steps(self, name):
        """Processes of the node's jobs: the tasks, and before them those that look after tasks."""
        tasks, keepers = [], []
        log = str(self.folder / f"slurmd.{name}.log")
        for path in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                environment = (path / "environ").read_bytes()
                if f"SLURMD_NODENAME={name}\0".encode() in environment and \
                        str(self.config).encode() in environment:
                    tasks.append(int(path.name))
                elif any(os.readlink(fd) == log for fd in (path / "fd").iterdir()):
                    keepers.append(int(path.name))
        return keepers + tasks

    def kill_node(self, name):
        """As when its power fails: nothing of it can tell the controller any more."""
        self.daemons[name].kill()
        self.daemons[name].wait()
        for process in self.steps(name):
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, 9)

    def stop(self):
        self.run("scancel", "-u", "root", check=False)
        for name in list(self.daemons):
            self.kill_node(name)


@contextlib.contextmanager
def running(folder):
    if os.geteuid() != 0:
        raise cli.Skip("not root")
    for program in ("slurmctld", "slurmd"):
        if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin"):
            raise cli.Skip(f"no {program}")
    farm = Farm(folder)
    try:
        farm.start()
        yield farm
    finally:
        farm.stop()
