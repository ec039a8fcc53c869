#!/usr/bin/env python3
"""The same bonded packing in flow, YADE, LAMMPS and a bare force loop, in turn, several times: ns per bond and step, and ratios.

    python3 tests/bench/peers.py [2d|3d] [PARTICLES] [--rounds 5] [--bench PATH] [--yade yade]
                                 [--lammps lmp] [--bare 'COMMAND {packing} {bonds}']

`cargo bench -p flow-dem --bench engine --no-run` prints the PATH of flow's bench; it makes the packing, too. A code whose
program is missing is left out, and named. One thread each. What each code does in a step:

flow    linear contact and parallel bond with moments and strengths, local damping, walls, contact search, cracks
YADE    CohFrict with moments (nearest to a parallel bond), local damping, contact search; end layers move
LAMMPS  bpm/rotational and gran/hooke/history, viscous damping of the bonds, neighbour lists; end layers move
bare    whatever the command does; it must print lines with `ns` as their last number

Other work on the machine only adds time, so each round counts its best stretch and the table shows the median of the rounds.
"""
import argparse
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def output(command, folder):
    """What a command prints; the end of it and a stop when it fails."""
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=3600)
    text = ran.stdout + ran.stderr
    if ran.returncode:
        sys.exit(f"{' '.join(map(str, command))}\nended with {ran.returncode}:\n{text[-2000:]}")
    return text


def flow(order, packing):
    """Best stretch of flow's bench, and its number of bonds."""
    text = output([order.bench, order.space, str(order.particles), "once", f"write={packing}", "--bench"], packing.parent)
    bonds = int(re.search(r"(\d+) bonds", text)[1])
    return float(re.search(r"best ([\d.]+)", text)[1]), bonds


def yade(order, packing, bonds):
    """Best stretch of YADE; it bonds by a factor on the radii, so it counts its own bonds."""
    text = output([order.yade, "-n", "-x", "-j1", str(HERE / "peers" / "yade.py"), str(packing)], packing.parent)
    return float(re.search(r"NS ([\d.]+)", text)[1])


def lammps(order, packing, bonds):
    """Best stretch of LAMMPS; the BONDS smallest gaps are bonded."""
    command = [sys.executable, str(HERE / "peers" / "lammps.py"), str(packing), str(bonds), order.lammps]
    return float(re.search(r"NS ([\d.]+)", output(command, packing.parent))[1])


def bare(order, packing, bonds):
    """Best line of the bare loop."""
    text = output(order.bare.format(packing=packing, bonds=bonds).split(), packing.parent)
    return min(float(line.split()[-1]) for line in text.splitlines() if re.search(r"[\d.]+$", line))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("space", nargs="?", default="2d", choices=["2d", "3d"])
    parser.add_argument("particles", nargs="?", type=int, default=22000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--bench", required=True, help="the engine bench as it was built")
    parser.add_argument("--yade", default="yade")
    parser.add_argument("--lammps", default="lmp")
    parser.add_argument("--bare", help="command of a bare loop, with {packing} and {bonds}")
    order = parser.parse_args()
    codes = {"yade": yade, "lammps": lammps}
    for name in [name for name in codes if not shutil.which(getattr(order, name))]:
        print(f"{name}: no program `{getattr(order, name)}`; left out")
        del codes[name]
    if order.bare:
        codes["bare"] = bare
    seen = {name: [] for name in ["flow", *codes]}
    with tempfile.TemporaryDirectory() as folder:
        packing = pathlib.Path(folder) / "packing.txt"
        for number in range(1, order.rounds + 1):
            own, bonds = flow(order, packing)
            seen["flow"].append(own)
            for name, run in codes.items():
                seen[name].append(run(order, packing, bonds))
            print(f"round {number}: " + ", ".join(f"{name} {times[-1]:.1f}" for name, times in seen.items()), flush=True)
    print(f"{order.space} {order.particles} particles, {bonds} bonds, medians of {order.rounds} rounds, ns per bond and step")
    for name, times in seen.items():
        ratios = [time / own for time, own in zip(times, seen["flow"])]
        print(f"{name:8} {statistics.median(times):8.2f}   {statistics.median(ratios):6.2f} times flow")


main()
