#!/usr/bin/env python3
"""What a calibration with the simulation in the loop costs beside its simulations.

    replay.py FLOW [EVALUATIONS ...]

The simulator is a formula, so all that is measured is flow: asking, keys, storing, reading back, and replaying the history.
Printed are processor time (user + system) and wall time per evaluation of a whole search, the time to take up a search that
stands one evaluation before its end, and the largest memory of the process.
"""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

FLOW = os.path.abspath(sys.argv[1])
COUNTS = [int(n) for n in sys.argv[2:]] or [1_000, 10_000]


def workflow(count):
    return f"""[workflow]
seed = 1
[factor]
{"".join(f"p{i} = {{ range = [1, 100], scale = 'log' }}{chr(10)}" for i in range(1, 10))}
[response]
y = {{}}
[stage.points]
kind = "design"
method = "latin-hypercube"
runs = 4
factors = [{", ".join(f"'p{i}'" for i in range(1, 10))}]
[stage.model]
kind = "formula"
design = "points"
responses.y = {{ value = "p1*p2*p3/(p4*p5*p6)*(p7/p8)*p9", scatter = 0.02 }}
[stage.search]
kind = "calibrate"
simulator = "model"
method = "annealing"
annealing = {{ preset = "wang2017" }}
factors = [{", ".join(f"'p{i}'" for i in range(1, 10))}]
targets = [{{ y = 30 }}]
stop_at = 1e-12
evaluations = {count}
"""


def run(folder):
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run([FLOW, "run", "w.toml", "--quiet", "--jobs", "1"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return processor, time.perf_counter() - started, after.ru_maxrss / 1024


print(f"{'evaluations':>11} {'ms each':>8} {'wall':>6} {'taken up again, s':>18} {'MB':>6}")
for count in COUNTS:
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "w.toml")
        file.write_text(workflow(count))
        processor, wall, _ = run(folder)
        file.write_text(workflow(count + 1))
        again, _, memory = run(folder)
        print(f"{count:>11} {1e3 * processor / count:>8.2f} {1e3 * wall / count:>6.2f} {again:>18.2f} {memory:>6.0f}")
