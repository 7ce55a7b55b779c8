"""Reading a mesh: Kluft (read, checked, sectored, numbered) against gmsh (read).

    python3 benches/peers/gmsh_reading.py [FILE.msh] [--runs N]

Without a file, gmsh meshes geometries/network-100 with the cell sizes it has (1.07 million cells,
somewhat more than a minute) into target/. The file is timed as binary and as text; both programs run in turn, so
that a machine that slows down slows both. gmsh's figure is that of its process; Kluft's is given from
opening the file to the numbered mesh, and for the whole process.
"""

import argparse
import json
import os
import re
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GMSH = os.environ.get("KLUFT_GMSH") or "gmsh"


def timed(command):
    """Seconds, peak memory (MB) and output of a process."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    output = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))} failed:\n{output}")
    return seconds, usage.ru_maxrss * 1024 / 1e6, output


def gmsh_reads(mesh, folder):
    """A script that merges and leaves: no part of gmsh but its reader has anything to do."""
    script = folder / "read.geo"
    script.write_text(f'Merge "{mesh}";\nPrintf("%g", Mesh.NbTetrahedra);\nExit;\n')
    seconds, megabytes, output = timed([GMSH, "-v", "2", str(script), "-"])
    if "Error" in output:
        raise SystemExit(output)
    return seconds, megabytes


def kluft_reads(mesh, program):
    whole, megabytes, output = timed([str(program), str(mesh)])
    inside = re.search(r"total ([\d.]+)", output)
    return float(inside.group(1)), whole, megabytes


def compare(name, mesh, program, folder, runs):
    gmsh, kluft = [], []
    for _ in range(runs + 1):
        gmsh.append(gmsh_reads(mesh, folder))
        kluft.append(kluft_reads(mesh, program))
    # The first run of each fills the system's cache of the file.
    gmsh, kluft = gmsh[1:], kluft[1:]
    middle = lambda rows, column: statistics.median(row[column] for row in rows)
    peer, own = middle(gmsh, 0), middle(kluft, 0)
    print(f"{name:7} gmsh  {peer:.3f} s, {middle(gmsh, 1):.0f} MB")
    print(
        f"        kluft {own:.3f} s ({middle(kluft, 1):.3f} s with the process), "
        f"{middle(kluft, 2):.0f} MB: {own / peer:.2f} of gmsh's time"
    )


def network():
    mesh = ROOT / "target" / "network-100.msh"
    if not mesh.exists():
        print("meshing network-100 ...")
        geometry = ROOT / "geometries" / "network-100" / "network-100.geo"
        options = ["-3", "-format", "msh41", "-bin", "-v", "2", "-o", str(mesh)]
        timed([GMSH, str(geometry), *options])
    return mesh


def rewritten(mesh, folder, is_binary):
    copy = folder / ("binary.msh" if is_binary else "text.msh")
    options = ["-save", "-save_all", "-format", "msh41", "-v", "2", "-o", str(copy)]
    timed([GMSH, str(mesh), *options, *(["-bin"] if is_binary else [])])
    return copy


def built():
    """The program of the measurement `reading`, which Cargo puts where it likes."""
    build = ["cargo", "bench", "--quiet", "--no-run", "--bench", "reading", "--message-format", "json"]
    output = subprocess.run(build, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    artifacts = [json.loads(line) for line in output.splitlines()]
    return next(a["executable"] for a in artifacts if a.get("executable") and a["target"]["name"] == "reading")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", type=Path)
    parser.add_argument("--runs", type=int, default=7)
    arguments = parser.parse_args()
    program = built()
    mesh = (arguments.mesh or network()).resolve()
    print(timed([str(program), str(mesh)])[2].strip())
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name, is_binary in [("binary", True), ("text", False)]:
            compare(name, rewritten(mesh, folder, is_binary), program, folder, arguments.runs)


if __name__ == "__main__":
    main()
