"""Runs one command and prints its wall time, processor time (s) and peak resident memory (bytes) as JSON.

    python measure.py LOG COMMAND...

A program of its own, because the peak that the kernel reports for a command includes what its parent held when it
started it: this one holds next to nothing. What the command prints goes to LOG.
"""

import json
import os
import sys
import time


def main():
    """Runs the command of the arguments and passes its exit code on."""
    log = os.open(sys.argv[1], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
    redirect = [(os.POSIX_SPAWN_DUP2, log, 1), (os.POSIX_SPAWN_DUP2, log, 2)]
    start = time.perf_counter()
    child = os.posix_spawnp(sys.argv[2], sys.argv[2:], os.environ, file_actions=redirect)
    _, status, usage = os.wait4(child, 0)
    seconds = time.perf_counter() - start
    processor = usage.ru_utime + usage.ru_stime
    peak = 1024 * usage.ru_maxrss
    print(json.dumps({"seconds": seconds, "processor_seconds": processor, "peak_memory_bytes": peak}))
    sys.exit(os.waitstatus_to_exitcode(status) != 0)


main()
