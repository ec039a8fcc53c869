#!/usr/bin/env python3
"""How certain a peak is once the stress has fallen: `python3 tests/bench/peaks.py STORE...` (needs h5py and numpy).

Of every stress-strain curve in the stores: had the test ended when the stress first fell to a share of the largest so far,
would a higher peak have been missed, and how much of the test would have been saved? The answer is what a `stop_fraction`
costs. Curves whose stress never fell so far do not count.
"""
import collections
import pathlib
import re
import sys

import h5py
import numpy

SHARES = [0.98, 0.95, 0.9, 0.85, 0.8]
SEATED = 0.1  # the rule is armed above this share of the largest stress

curves = collections.defaultdict(dict)
for store in sys.argv[1:]:
    for path in pathlib.Path(store).glob("objects/*/*.h5"):
        with h5py.File(path) as file:
            if "curve" not in file or "stress" not in file["curve"]:
                continue
            task = file.attrs.get("task", "")
            task = task.decode() if isinstance(task, bytes) else str(task)
            kind = re.search(r'test\.kind "([a-z]+)"', task)
            # Equal results of several stores count once: an object is named by its content.
            curves[kind[1] if kind else "uniaxial"][path.name[:64]] = numpy.array(file["curve/stress"])

print("test        ends at   curves   peak missed   by at most   samples saved")
for kind, found in sorted(curves.items()):
    for share in SHARES:
        missed, saved = [], []
        for stress in found.values():
            largest = numpy.maximum.accumulate(stress)
            fallen = (largest > SEATED * stress.max()) & (stress <= share * largest)
            if fallen.any():
                end = int(fallen.argmax())
                missed.append(stress.max() / largest[end] - 1.0)
                saved.append(1.0 - (end + 1) / len(stress))
        if missed:
            wrong = sum(part > 0.0 for part in missed)
            print(
                f"{kind:10}  {share:7.2f}  {len(missed):7}   {100 * wrong / len(missed):9.1f} %"
                f"   {100 * max(missed):8.1f} %   {100 * numpy.mean(saved):11.1f} %"
            )
