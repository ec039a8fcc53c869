#!/usr/bin/env python3
"""Makes HDF5 files that are valid and that no reader should follow blindly (h5py 3.16, HDF5 2.0).

    make.py          writes them beside this script
"""
import pathlib

import h5py
import numpy as np

here = pathlib.Path(__file__).parent


def artifact(name):
    file = h5py.File(here / f"{name}.h5", "w", libver="latest")
    file.attrs["kind"] = "hostile"
    file.attrs["task"] = name
    file.attrs["version"] = np.int64(1)
    file.attrs["layout"] = np.int64(1)
    return file


# 128 TiB of zeros that were never written: 1 kB of file.
with artifact("contiguous") as file:
    file.create_dataset("x", shape=(2**44,), dtype="f8")
# The same in compressed pieces.
with artifact("chunked") as file:
    file.create_dataset("x", shape=(2**44,), dtype="f8", chunks=(2**20,), compression="gzip")
# 2^44 texts that were never written.
with artifact("texts") as file:
    file.create_dataset("x", shape=(2**44,), dtype=h5py.string_dtype())
# A group that contains the root.
with artifact("cycle") as file:
    file.create_group("g")["loop"] = file["/"]
# Two links, each to a group with two links to the next: 2^20 paths through 20 groups.
with artifact("many_paths") as file:
    groups = [file.create_group("g")]
    for level in range(20):
        below = file.create_group(f"hidden{level}")
        groups[-1]["a"] = below
        groups[-1]["b"] = below
        groups.append(below)
        del file[f"hidden{level}"]
    groups[-1]["end"] = np.int64(1)
