"""Runs a program of the benchmarks that prints one line of JSON."""

import json
import subprocess
import sys


def measured(program, *arguments):
    """What the program prints. If it lacks what it needs (exit code 2), its message ends the benchmark."""
    ran = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if ran.returncode == 2:
        sys.exit(ran.stderr.strip())
    ran.check_returncode()
    return json.loads(ran.stdout)
