#!/usr/bin/env python3
"""A bonded packing between two end layers that close, in LAMMPS (package BPM): `lammps.py PACKING BONDS PROGRAM` prints `NS`,
the best stretch in ns per bond and step. The BONDS pairs with the smallest gaps are bonded by `bond_style bpm/rotational`;
contacts are `gran/hooke/history`. Local damping is not known there, so the bonds' own viscous damping takes its place.
Needs numpy and scipy. Of LAMMPS' loop time, the share in which it had the processor counts."""
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy
from scipy.spatial import cKDTree

STEPS, STRETCHES = 50, 8
SPEED, MODULUS, DENSITY = 0.02, 20e9, 2000.0

path, wanted, program = sys.argv[1], int(sys.argv[2]), sys.argv[3]
dimension = int(open(path).readline().split()[1])
table = numpy.loadtxt(path)
centres, radii = table[:, :3], table[:, 3]
pairs = cKDTree(centres).query_pairs(2.2 * radii.max(), output_type="ndarray")
first, second = pairs.T
gaps = numpy.linalg.norm(centres[first] - centres[second], axis=1) - radii[first] - radii[second]
pairs = pairs[numpy.argsort(gaps)[:wanted]]
mean = radii.mean()
low, high = centres.min(0) - 4 * mean, centres.max(0) + 4 * mean
if dimension == 2:
    low[2], high[2] = -mean, mean
bottom, top = centres[:, 1].min() + mean, centres[:, 1].max() - mean

normal = MODULUS * numpy.pi * mean / 2
shear, turning = normal / 2.5, normal / 2.5 * mean**2 / 2
drag = 0.1 * numpy.sqrt(normal * DENSITY * 4 / 3 * numpy.pi * mean**3)
step = 0.1 * numpy.sqrt(DENSITY * 4 / 3 * numpy.pi * radii.min() ** 3 / normal)

data = [f"a packing\n\n{len(radii)} atoms\n{len(pairs)} bonds\n1 atom types\n1 bond types"]
data += ["30 extra bond per atom\n60 extra special per atom"]
data += [f"{low[k]:.9g} {high[k]:.9g} {axis}lo {axis}hi" for k, axis in enumerate("xyz")]
data += ["\nAtoms # bpm/sphere\n"]
data += [f"{i + 1} 1 1 {2 * r:.12g} {DENSITY} {x:.12g} {y:.12g} {z:.12g}" for i, ((x, y, z), r) in enumerate(zip(centres, radii))]
data += ["\nBonds\n"] + [f"{k + 1} 1 {i + 1} {j + 1}" for k, (i, j) in enumerate(pairs)]

plane = dimension == 2
script = f"""units si
dimension {dimension}
atom_style bpm/sphere
boundary f f {"p" if plane else "f"}
newton on off
comm_modify vel yes
special_bonds lj 1 1 1 coul 1 1 1
read_data data
neighbor {0.3 * mean} bin
neigh_modify every 1 delay 0 check yes
region bottom block INF INF INF {bottom} INF INF
region top block INF INF {top} INF INF INF
group bottom region bottom
group top region top
group grips union bottom top
group free subtract all grips
bond_style bpm/rotational overlay/pair yes
bond_coeff 1 {normal} {shear} {turning} {turning} 1e9 1e9 1e9 1e9 {drag} {0.4 * drag} {0.2 * drag * mean**2} {0.2 * drag * mean**2}
pair_style gran/hooke/history {normal} NULL 0.0 NULL 0.5 0
pair_coeff * *
fix 1 free nve/bpm/sphere {"disc" if plane else ""}
fix 2 bottom move linear 0 {SPEED} 0
fix 3 top move linear 0 {-SPEED} 0
{"fix 4 all enforce2d" if plane else ""}
timestep {step}
thermo 1000000
run {STEPS} post no
""" + f"run {STEPS} pre no\n" * STRETCHES
with tempfile.TemporaryDirectory() as folder:
    pathlib.Path(folder, "data").write_text("\n".join(data) + "\n")
    pathlib.Path(folder, "in").write_text(script)
    command = [program, "-in", "in", "-log", "none"]
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=3000)
found = re.findall(r"Loop time of (\S+) on .*?([\d.]+)% CPU use", ran.stdout, re.S)
if len(found) < 2:
    sys.exit(ran.stdout[-2000:] + ran.stderr)
best = min(float(time) * float(share) / 100 for time, share in found)
print("BONDS", len(pairs))
print("NS", best * 1e9 / STEPS / len(pairs))
