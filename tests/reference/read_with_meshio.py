#!/usr/bin/env python3
"""Reads the files that tests/cli/export.rs has exported, with meshio, and compares them with the CSV files beside them.

meshio 5.3.5, numpy 2.4.6. The CSV files are written by another part of flow, and the cross-checks below (lengths, ends,
equilibrium) do not come from it at all.
"""
import csv
import sys
import xml.etree.ElementTree
from pathlib import Path

import meshio
import numpy as np

folder = Path(sys.argv[1])


# Units of the CSV files, which are those of the field; the grids are in SI units.
SI = {"MPa": 1e6, "kN": 1e3, "mm": 1e-3}


def table(name):
    with open(folder / name, newline="") as file:
        rows = list(csv.DictReader(file))
    columns = {}
    for head in rows[0]:
        plain, _, unit = head.partition(" [")
        columns[plain] = ([row[head] for row in rows], SI.get(unit.rstrip("]"), 1.0))
    return columns


def texts(columns, name):
    return columns[name][0]


def numbers(columns, name):
    values, factor = columns[name]
    return np.array([float(value) for value in values]) * factor


def cells(mesh, kind):
    assert [block.type for block in mesh.cells] == [kind], mesh.cells
    return mesh.cells[0].data


# The specimen: discs, contacts, clumps.
discs = table("trial.particles.csv")
start = meshio.read(folder / "specimen.particles.vtu")
assert len(cells(start, "vertex")) == len(texts(discs, "id"))
assert np.array_equal(start.points[:, 0], numbers(discs, "x")) and np.array_equal(start.points[:, 1], numbers(discs, "y"))
assert np.array_equal(start.point_data["radius"], numbers(discs, "radius"))
assert np.array_equal(start.point_data["clump"], numbers(discs, "clump"))
assert np.array_equal(start.point_data["group"], start.point_data["clump"] >= 0)
contacts = meshio.read(folder / "specimen.contacts.vtu")
ends = cells(contacts, "line")
listed = table("trial.contacts.csv")
assert np.array_equal(ends[:, 0], numbers(listed, "first")) and np.array_equal(ends[:, 1], numbers(listed, "second"))
length = np.linalg.norm(contacts.points[ends[:, 1]] - contacts.points[ends[:, 0]], axis=1)
radius = start.point_data["radius"]
gap = length - radius[ends[:, 0]] - radius[ends[:, 1]]
assert np.allclose(contacts.cell_data["gap"][0], gap, atol=1e-12) and gap.max() <= 0
clumps = meshio.read(folder / "specimen.clumps.vtu")
assert all(block.type == "polygon" for block in clumps.cells)
assert sum(len(block.data) for block in clumps.cells) >= len(texts(table("trial.clumps.csv"), "id")) > 0

# The states of the run, over the axial strain.
series = xml.etree.ElementTree.parse(folder / "trial.pvd").getroot()[0]
sets = [(float(one.get("timestep")), int(one.get("part")), one.get("file")) for one in series]
strains = sorted({one[0] for one in sets})
states = table("trial.states.csv")
assert np.allclose(strains, sorted(set(numbers(states, "axial_strain"))), rtol=1e-12)
forces, cracks = table("trial.forces.csv"), table("trial.cracks.csv")
width = 0.04
for strain, part, file in sets:
    mesh = meshio.read(folder / file)
    state = int(file.split(".")[-2])
    stress = numbers(states, "stress")[state]
    if part == 0:
        moved = mesh.points - start.points
        assert np.allclose(mesh.point_data["displacement"], moved, atol=1e-15)
        # The upper half has come down, the lower half up.
        assert np.sign(moved[start.points[:, 1] > 0.03, 1].mean()) == -np.sign(moved[start.points[:, 1] < -0.03, 1].mean())
    elif part == 1:
        lines = cells(mesh, "line")
        own = numbers(forces, "state") == state
        normal = mesh.cell_data["normal_force"][0]
        assert np.allclose(normal, numbers(forces, "normal_force")[own], rtol=1e-12, atol=0)
        assert np.array_equal(lines[:, 0], numbers(forces, "first")[own])
        chain = mesh.cell_data["chain"][0] == 1
        assert np.array_equal(chain, np.abs(normal) >= np.abs(normal).mean()) and 0 < chain.mean() < 0.6
        # The trace of the stress is the sum of normal force times length over the area; the platens' share is missing.
        branch = np.linalg.norm(mesh.points[lines[:, 1]] - mesh.points[lines[:, 0]], axis=1)
        load = (normal * branch).sum() / (stress * width * 0.08 * (1 - strain))
        assert 0.85 < load < 1.02, load
    else:
        open_ = numbers(cracks, "axial_strain") <= strain
        assert len(cells(mesh, "line")) == open_.sum() > 0
        middle = mesh.points[mesh.cells[0].data].mean(axis=1)
        assert np.allclose(middle[:, 0], numbers(cracks, "position_x")[open_], atol=1e-12)
        along = mesh.points[mesh.cells[0].data[:, 1]] - mesh.points[mesh.cells[0].data[:, 0]]
        assert np.allclose(np.linalg.norm(along, axis=1), numbers(cracks, "size")[open_], atol=1e-12)
        across = along[:, 0] * numbers(cracks, "normal_x")[open_] + along[:, 1] * numbers(cracks, "normal_y")[open_]
        assert np.allclose(across, 0, atol=1e-12)
print(len(sets), "grids read")
