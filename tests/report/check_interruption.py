#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A report that is interrupted ends with exit code 130 and leaves nothing. The program is $NSCDD_PROGRAM."""
import os
import signal
import subprocess
import sys
import tempfile
import time

# Some minutes of work, were it not interrupted; the signal comes when the program is at it, however slow it starts.
COMMAND = ["report", "hexagonal", "--set", "packing.columns=60", "--set", "packing.rows=60", "--subdomains", "6x6",
           "--epsilon", "1e-3:1e3:50", "--eta", "1e-3:1e3:50", "-o", "page.html"]


def catches(process):
    """Whether the program has its handler for SIGINT, which it sets just before the work."""
    with open(f"/proc/{process.pid}/status", encoding="utf-8") as stream:
        caught = next(line for line in stream if line.startswith("SigCgt:"))
    return int(caught.split()[1], 16) >> (signal.SIGINT - 1) & 1


def main():
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, NSCDD_DATA=os.environ["NSCDD_SOURCE"])
        with subprocess.Popen([os.environ["NSCDD_PROGRAM"], *COMMAND], cwd=folder, env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
            started = time.monotonic()
            while process.poll() is None and not catches(process) and time.monotonic() < started + 120:
                time.sleep(0.02)
            process.send_signal(signal.SIGINT)
            output, errors = process.communicate(timeout=240)
        left = os.listdir(folder)
    if process.returncode != 130 or output or left or "interrupted; nothing was written" not in errors:
        sys.exit(f"expected exit code 130 and no file, met {process.returncode}, {left}, {output}{errors}")
    print("exit code 130, no file")


if __name__ == "__main__":
    main()
