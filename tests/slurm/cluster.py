"""A Slurm of its own for a test: munged, slurmctld, two slurmd in fresh PID, mount, network and host-name namespaces.

Nothing outside is touched: its processes cannot be seen from there nor see anything there, they die with the test, and
they talk over a loopback nobody else has.
"""
import fcntl
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import sys
import time

NODES = ("n1", "n2")
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol", "unshare")
INSIDE = "ACCDEC_SLURM_TEST_INSIDE"

CONF = """ClusterName=accdectest
SlurmctldHost=accdectest(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={home}/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={home}/state
SlurmdSpoolDir={home}/spool-%n
SlurmctldPidFile={home}/slurmctld.pid
SlurmdPidFile={home}/slurmd-%n.pid
SlurmctldLogFile={home}/slurmctld.log
SlurmdLogFile={home}/slurmd-%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SlurmdTimeout=6
SlurmctldTimeout=10
ReturnToService=2
MpiDefault=none
SchedulerParameters=sched_interval=2,bf_interval=2
NodeName=n1 NodeAddr=127.0.0.1 Port=17001 CPUs=1 State=UNKNOWN
NodeName=n2 NodeAddr=127.0.0.1 Port=17002 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""


def missing():
    """Why there can be no cluster here; empty if there can."""
    if os.geteuid() != 0:
        return "needs root, for namespaces of its own"
    absent = [p for p in PROGRAMS if not shutil.which(p)]
    if absent:
        return f"{', '.join(absent)} not installed (Debian packages slurm-wlm and munge)"
    tried = subprocess.run(unshare() + ["true"], capture_output=True, text=True)
    return "" if tried.returncode == 0 else f"no namespaces here: {tried.stderr.strip()}"


def unshare():
    return ["unshare", "--pid", "--mount", "--net", "--uts", "--fork", "--kill-child", "--mount-proc"]


def enter():
    """Runs this program again inside the namespaces and ends with its exit code; returns inside."""
    if INSIDE in os.environ:
        reap()
        return
    result = subprocess.run(unshare() + [sys.executable] + sys.argv, env=os.environ | {INSIDE: "1"})
    sys.exit(result.returncode)


def reap():
    """Leaves the first process of the namespace to bury the dead, which Slurm would wait for; returns in a child."""
    child = os.fork()
    while child:
        pid, status = os.wait()
        if pid == child:
            os._exit(os.waitstatus_to_exitcode(status) & 0xFF)


def loopback_up():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as s:
        flags = struct.pack("16sh", b"lo", 0x1 | 0x40)  # IFF_UP | IFF_RUNNING
        fcntl.ioctl(s, 0x8914, flags + bytes(14))  # SIOCSIFFLAGS
        # Slurm asks for addresses of the families that the host has, for which 127.0.0.1 alone does not count.
        second = struct.pack("16sH2s4s8s", b"lo:1", socket.AF_INET, b"", socket.inet_aton("10.77.0.1"), b"")
        fcntl.ioctl(s, 0x8916, second)  # SIOCSIFADDR


class Cluster:
    def __init__(self, home):
        self.home = pathlib.Path(home)
        loopback_up()
        socket.sethostname("accdectest")
        hosts = self.home / "hosts"
        hosts.write_text("127.0.0.1 localhost accdectest n1 n2\n")
        subprocess.run(["mount", "--make-rprivate", "/"], check=True)
        subprocess.run(["mount", "--bind", str(hosts), "/etc/hosts"], check=True)
        (self.home / "slurm.conf").write_text(CONF.format(home=self.home))
        (self.home / "state").mkdir()
        for node in NODES:
            (self.home / f"spool-{node}").mkdir()
        os.environ["SLURM_CONF"] = str(self.home / "slurm.conf")
        self.start_munge()
        subprocess.run(["slurmctld", "-c"], check=True)
        for node in NODES:
            self.start_node(node)
        self.wait_for(lambda: self.idle() == len(NODES), 60, "both nodes to be idle")

    def start_munge(self):
        key = self.home / "munge.key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        self.home.chmod(0o755)
        at = lambda name: str(self.home / name)
        subprocess.run(["munged", "--force", f"--socket={at('munge.socket')}", f"--key-file={key}",
                        f"--log-file={at('munged.log')}", f"--pid-file={at('munged.pid')}",
                        f"--seed-file={at('munged.seed')}"], check=True)

    def start_node(self, node):
        subprocess.run(["slurmd", "-N", node], check=True)

    def idle(self):
        states = subprocess.run(["sinfo", "-h", "-N", "-o", "%T"], capture_output=True, text=True).stdout.split()
        return sum(s in ("idle", "mixed", "allocated") for s in states)

    def kill_node(self, node):
        """What a power cut leaves of a node: nothing. Its slurmd, its steps and their tasks go at once."""
        pids = [int((self.home / f"slurmd-{node}.pid").read_text())]
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            try:
                environment = (entry / "environ").read_bytes().split(b"\0")
                if f"SLURMD_NODENAME={node}".encode() in environment:
                    pids.append(int(entry.name))
                    pids.append(int((entry / "stat").read_text().rpartition(")")[2].split()[1]))  # its slurmstepd
            except (FileNotFoundError, ProcessLookupError):
                continue
        for pid in pids:
            if pid > 2:
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
        return len(pids)

    def queue(self):
        lines = subprocess.run(["squeue", "-h", "-r", "-o", "%F|%K|%t|%N"], capture_output=True, text=True)
        return [line.split("|") for line in lines.stdout.splitlines()]

    def logs(self):
        for log in sorted(self.home.glob("*.log")):
            print(f"---- {log.name}\n{log.read_text(errors='replace')[-3000:]}", file=sys.stderr)

    def wait_for(self, condition, seconds, what):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                self.logs()
                sys.exit(f"slurm test: waited {seconds} s in vain for {what}; queue: {self.queue()}")
            time.sleep(0.2)
