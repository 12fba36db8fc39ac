"""What a table of measurements says of itself in its first line."""
import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def git(*words):
    return subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True).stdout.strip()


def describe():
    """Commit, processor and its load now: a busy machine measures itself."""
    changed = " (changed)" if git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!results") else ""
    names = re.findall(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.MULTILINE)
    processor = f"{len(os.sched_getaffinity(0))} threads of {names[0]}" if names else "processor unknown"
    return f"commit {git('rev-parse', '--short', 'HEAD')}{changed}, {processor}, load {os.getloadavg()[0]:.2f}"
