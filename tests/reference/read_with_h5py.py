#!/usr/bin/env python3
"""Reads the object that tests/store/readers.rs has written, with h5py, and compares every value, type, unit and text.

Values stand here a second time on purpose: the file must say them without any code of ours.
"""
import sys

import h5py
import numpy as np


def text(value):
    return value.decode() if isinstance(value, bytes) else value


with h5py.File(sys.argv[1], "r") as file:
    assert file.attrs["kind"] == "everything", file.attrs["kind"]
    assert file.attrs["version"] == 4
    assert file.attrs["task"] == "work = everything 1\n" * 5000
    assert sorted(file) == ["Ec", "curve", "failed", "levels", "picture", "reason", "steps"], sorted(file)

    assert file["Ec"][()] == 3.1e10 and file["Ec"].dtype == np.float64 and text(file["Ec"].attrs["unit"]) == "Pa"
    assert file["steps"][()] == -7 and file["steps"].dtype == np.int64
    assert file["failed"][()] is np.True_ or file["failed"][()] == True and file["failed"].dtype == np.bool_
    assert text(file["reason"][()]) == "no peak: σ fell\nbelow"
    assert file["picture"].dtype == np.uint8 and bytes(file["picture"][:]) == bytes(range(256)) * 39 + bytes(range(16))

    levels = file["levels"]
    assert text(levels.attrs["class"]) == "table" and text(levels.attrs["about"]) == "levels"
    assert [text(name) for name in levels.attrs["columns"]] == ["σ_c", "row", "mode"]
    strength = levels["σ_c"]
    assert text(strength.attrs["unit"]) == "Pa" and text(strength.attrs["about"]) == "strength"
    np.testing.assert_array_equal(strength[:], [1.5, np.nan, -3e300])
    np.testing.assert_array_equal(levels["row"][:], [1, 2, -(2**63)])
    assert list(levels["mode"].asstr()[:]) == ["shear", "", "déchirure"]

    strain = file["curve/strain"]
    assert strain.compression == "gzip" and strain.shuffle and text(strain.attrs["unit"]) == "Pa"
    np.testing.assert_array_equal(strain[:], np.arange(3000) * 1e-6)
    np.testing.assert_array_equal(file["curve/long"][:], np.arange(200_000))
    np.testing.assert_array_equal(file["curve/cracks"][:], [[1, 2, 3], [4, 5, 6]])
print("all values as written")
