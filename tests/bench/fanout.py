#!/usr/bin/env python3
"""Times `flow run` on a fan-out of trivial tasks: one root, N rows, one gather.

    fanout.py FLOW [N] [REPETITIONS]

Prints wall time and processor time (user + system, of the process and its threads) of a cold run, a run that finds
everything done, and a run after one parameter of one row has changed; minima of the repetitions.
"""
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

FLOW = os.path.abspath(sys.argv[1])
N = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
REPETITIONS = int(sys.argv[3]) if len(sys.argv) > 3 else 3


def workflow(changed):
    levels = [str(i) for i in range(1, N + 1)]
    levels[N // 2] = str(N // 2 + 1 + 0.25 * changed)
    return f"""[workflow]
seed = 1
[factor]
a = {{ sets = "mortar.a", symbol = 'a', levels = [{", ".join(levels)}] }}
[response]
y = {{ unit = "MPa", symbol = 'y' }}
[material.base]
mortar = {{ a = 1 }}
[stage.root]
kind = "design"
method = "full-factorial"
factors = ["a"]
[stage.rows]
kind = "formula"
design = "root"
material = "base"
responses.y = {{ value = "3*a", unit = "MPa" }}
"""


def timed(folder, expected):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    done = subprocess.run([FLOW, "run", "w.toml", "--quiet", "--json"], cwd=folder, capture_output=True, check=True)
    wall = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran = json.loads(done.stdout.splitlines()[-1])["tasks"]["ran"]
    assert expected is None or ran == expected, f"{ran} tasks ran instead of {expected}"
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


rows = {"cold": [], "nothing changed": [], "one row changed": []}
for repetition in range(REPETITIONS):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "w.toml"
        file.write_text(workflow(0))
        rows["cold"].append(timed(folder, N + 2))
        for _ in range(3):
            rows["nothing changed"].append(timed(folder, 0))
        for change in (1, 2):
            file.write_text(workflow(change))
            rows["one row changed"].append(timed(folder, None))
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
for name, times in rows.items():
    wall, processor = (min(column) for column in zip(*times))
    per = f", {wall / N * 1e3:.3f} ms a task" if name == "cold" else ""
    print(f"{name:16} {wall * 1e3:9.1f} ms wall {processor * 1e3:9.1f} ms processor{per}")
print(f"{'memory':16} {peak:9.1f} MB at most")
