#!/usr/bin/env python3
"""Clumps of a `shapes` stage beside those of an independent program, on the same solids.

usage: clumps.py FOLDER, with what `flow export W shapes --to stl` and `--to particles` wrote.

clump-python 0.3.3 (Angelidakis et al. 2021, doi:10.1016/j.softx.2021.100735), trimesh, numpy, scipy. Two questions:
1. Are our numbers right? Volume and principal inertia of each clump, as the list for LAMMPS states them, against counting voxels
   in the union of its pebbles; the volume of each solid is that of trimesh.
2. Are our clumps good? As many pebbles by clump-python's Euclidean transform (any overlap from 0.5 to 0.9, its best) and its
   Favier method: errors of volume and of the largest principal inertia against the solid, method by method.
The script fails when a number of ours is off by more than 1 % from the count, or when our clump is no better than the best of theirs
in volume.
"""
import contextlib
import io
import sys
from pathlib import Path

import numpy as np
import trimesh
from CLUMP import GenerateClump_Euclidean_3D, GenerateClump_Favier

VOXELS = 160  # along the longest side
MM = 1e-3  # the STL files count in mm, the lists in m


def union(centres, radii):
    """Volume and principal moments of inertia (unit density) of a union of balls, by counting voxels."""
    low, high = (centres - radii[:, None]).min(0), (centres + radii[:, None]).max(0)
    step = (high - low).max() / VOXELS
    axes = [np.arange(a + 0.5 * step, b, step) for a, b in zip(low, high)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    inside = np.zeros(len(grid), bool)
    for centre, radius in zip(centres, radii):
        inside |= ((grid - centre) ** 2).sum(1) < radius**2
    points = grid[inside]
    return moments(points, step**3 * np.ones(len(points)))


def moments(points, weights):
    arms = points - np.average(points, axis=0, weights=weights)
    square = (weights[:, None, None] * (arms[:, :, None] * arms[:, None, :])).sum(0)
    return weights.sum(), np.sort(np.linalg.eigvalsh(np.trace(square) * np.eye(3) - square))


def ours(path):
    """Centres, radii, volume and principal inertia of a molecule file."""
    sections, head, current = {}, {}, None
    for line in path.read_text().splitlines()[1:]:
        words = line.split()
        if not words:
            continue
        if words[0][0].isalpha():
            current = sections.setdefault(words[0], [])
        elif current is None:
            head[words[-1]] = [float(word) for word in words[:-1]]
        else:
            current.append([float(word) for word in words[1:]])
    xx, yy, zz, xy, xz, yz = head["inertia"]
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    diameters = np.array(sections["Diameters"])[:, 0]
    return np.array(sections["Coords"]), diameters / 2, head["mass"][0], np.sort(np.linalg.eigvalsh(tensor))


def theirs(stl, count):
    """Their best clumps of at most so many pebbles, by method."""
    found = {}
    for overlap in (0.5, 0.6, 0.7, 0.8, 0.9):
        with contextlib.redirect_stdout(io.StringIO()):
            _, clump = GenerateClump_Euclidean_3D(str(stl), count, 0, 60, overlap)
        found[f"Euclidean {overlap}"] = clump
    # Its Favier method takes slices along the longest side and fails where one holds no vertex of the surface.
    with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(ValueError):
        _, found["Favier"] = GenerateClump_Favier(str(stl), count)
    return {name: union(MM * np.asarray(c.positions), MM * np.asarray(c.radii).ravel()) for name, c in found.items()}


def main():
    folder, faults = Path(sys.argv[1]), []
    print("shape              pebbles  method          volume error %  inertia error %")
    for stl in sorted(folder.glob("*.stl")):
        solid = trimesh.load_mesh(stl)
        solid.apply_scale(MM)
        volume, inertia = solid.volume, np.sort(solid.principal_inertia_components)
        centres, radii, said, said_inertia = ours(stl.with_suffix(".lammps.txt"))
        counted, counted_inertia = union(centres, radii)
        if abs(said / counted - 1) > 0.01 or np.abs(said_inertia / counted_inertia - 1).max() > 0.01:
            faults.append(f"{stl.stem}: volume {said:.4e} and inertia {said_inertia}, counted {counted:.4e} and {counted_inertia}")
        errors = {"flow": (counted, counted_inertia)} | theirs(stl, len(radii))
        for method, (v, i) in errors.items():
            errors[method] = (100 * (v / volume - 1), 100 * np.abs(i / inertia - 1).max())
            print(f"{stl.stem:18s} {len(radii):7d}  {method:14s} {errors[method][0]:14.2f} {errors[method][1]:16.2f}")
        best = min(abs(error[0]) for method, error in errors.items() if method != "flow")
        if abs(errors["flow"][0]) > best:
            faults.append(f"{stl.stem}: our volume is off by {errors['flow'][0]:.2f} %, their best by {best:.2f} %")
    print("\n".join(faults) if faults else "no fault")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
