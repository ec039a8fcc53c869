#!/usr/bin/env python3
"""Times `flow run` on a fan-out of trivial tasks (one root, N rows, one gather) beside other tools that do the same.

    fanout.py FLOW [N] [REPETITIONS]

Ninja and n2 take part when they are on the PATH: each of their tasks writes one small file by a shell, the last one
joins them. Runs of all tools alternate, so that what else the machine does meets all alike. Printed are wall time and
processor time (user + system, of the process and its children) of a cold run, a run that finds everything done, and a
run after one parameter of one row has changed: minima of the repetitions, and wall time as a ratio to flow's.
"""
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

FLOW = os.path.abspath(sys.argv[1])
N = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
REPETITIONS = int(sys.argv[3]) if len(sys.argv) > 3 else 3
CASES = ["cold", "nothing changed", "one row changed"]


def workflow(changed):
    levels = [str(i) for i in range(1, N + 1)]
    levels[N // 2] = str(N // 2 + 1 + 0.0625 * changed)
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


def build(changed):
    value = [str(i + 1) for i in range(N)]
    value[N // 2] += f".{changed}"
    lines = ["rule sh", "  command = $cmd", "build root.txt: sh", "  cmd = echo root > root.txt"]
    for i in range(N):
        lines += [f"build out/{i}.txt: sh root.txt", f"  cmd = cat root.txt > out/{i}.txt; echo {value[i]} >> out/{i}.txt"]
    lines += ["build sum.txt: sh " + " ".join(f"out/{i}.txt" for i in range(N))]
    lines += ["  cmd = find out -name '*.txt' | sort | xargs cat > sum.txt", "default sum.txt", ""]
    return "\n".join(lines)


TOOLS = {"flow": ("w.toml", workflow, [FLOW, "run", "w.toml", "--quiet", "--json"])}
for tool in ("n2", "ninja"):
    if shutil.which(tool):
        TOOLS[tool] = ("build.ninja", build, [tool, "-j", str(os.cpu_count())])


def timed(tool, folder, expected):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.perf_counter()
    done = subprocess.run(TOOLS[tool][2], cwd=folder, capture_output=True, check=True)
    wall = time.perf_counter() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if tool == "flow":
        ran = json.loads(done.stdout.splitlines()[-1])["tasks"]["ran"]
        assert ran == expected, f"{ran} tasks ran instead of {expected}"
        memory.append(float(after.ru_maxrss) / 1024)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


times = {(tool, case): [] for tool in TOOLS for case in CASES}
memory = []
with tempfile.TemporaryDirectory() as scratch:
    for repetition in range(REPETITIONS):
        folders = {tool: pathlib.Path(scratch) / f"{tool}{repetition}" for tool in TOOLS}

        def describe(changed):
            for tool, (name, text, _) in TOOLS.items():
                (folders[tool] / "out").mkdir(parents=True, exist_ok=True)
                (folders[tool] / name).write_text(text(changed))

        def measure(case, expected):
            for tool in TOOLS:
                times[tool, case].append(timed(tool, folders[tool], expected))

        describe(0)
        measure("cold", N + 2)
        time.sleep(2.5)  # Folders that have just changed are listed again.
        for _ in range(4):
            measure("nothing changed", 0)
        for changed in (1, 2, 3):
            describe(changed)
            measure("one row changed", 3)

for case in CASES:
    least = {tool: [min(column) for column in zip(*times[tool, case])] for tool in TOOLS}
    for tool, (wall, processor) in least.items():
        per = f", {wall / N * 1e3:.3f} ms a task" if case == "cold" else ""
        ratio = f", {wall / least['flow'][0]:.2f} times flow" if tool != "flow" else ""
        print(f"{case:16} {tool:6} {wall * 1e3:9.1f} ms wall {processor * 1e3:9.1f} ms processor{per}{ratio}")
print(f"memory of flow   {memory[0]:.0f} MB at most")
