#!/usr/bin/env bash
# Measures flow on a real Slurm, by hand: bash tests/cluster/measure.sh [STEP…]
#
# Wanted: sbatch, squeue and scancel in PATH (SLURM_CONF set, if that is not the system's), nodes with 8 CPUs in all, whose
# processes this machine can see, as of a Slurm with several slurmd on one machine; and a release build. FLOW names the program.
# Without steps all are measured: trivial half node submitter memory walltime ctrlc hangup. Each prints one line.
set -uo pipefail
cd "$(dirname "$0")/../.."
flow=${FLOW:-$PWD/target/release/flow}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

# Counts what is asked of the scheduler.
mkdir bin
real=$(command -v squeue) sbatch=$(command -v sbatch)
printf '#!/bin/sh\necho >>%s/squeue.calls\nexec %s "$@"\n' "$work" "$real" >bin/squeue
printf '#!/bin/sh\necho >>%s/sbatch.calls\nexec %s "$@"\n' "$work" "$sbatch" >bin/sbatch
chmod +x bin/*
PATH=$work/bin:$PATH
asked() { wc -l 2>/dev/null <"$work/$1.calls" || echo 0; }

site() { printf 'workers = 8\nmemory = "200 MB"\ntime = "%s"\nlinger = "5 s"\n[stage.formula]\nhere = false\n' "${1:-30 min}" >site.toml; }
head='[workflow]
seed = 1
[response]
y = {}
[material.base]
m = { a = 1 }
[stage.grid]
kind = "design"
method = "full-factorial"
factors = ["a"]'
levels() { seq -s, "$1"; }
# N tasks that run COMMAND, with their number in the file `in`.
commands() {
  echo '{{a}}' >in.txt
  printf '%s\n[factor]\na = { sets = "m.a", levels = [%s] }\n[stage.rows]\nkind = "command"\ndesign = "grid"\nmaterial = "base"\n' "$head" "$(levels "$1")" >w.toml
  printf 'run = ["sh", "-c", "echo x >>%s/log; %s; echo v=$(cat in)"]\ntemplates = { "in" = "in.txt" }\nread.y = { file = "stdout", pattern = %s }\n' \
    "$work" "$2" "'v=(\\d+)'" >>w.toml
}
fresh() { rm -rf store log ./*.calls; site "${1:-}"; }
run() { "$flow" run w.toml --executor slurm --site site.toml --json "$@" 2>said; }
field() { python3 -c 'import json,sys; d=json.loads(open(sys.argv[1]).read().splitlines()[-1]); print(eval(sys.argv[2]))' "$1" "$2"; }
done_of() { wc -l 2>/dev/null <log || echo 0; }
until_done() { until [ "$(done_of)" -ge "$1" ]; do sleep 0.05; done; }
settle() { until [ -z "$("$real" -h -o %i)" ]; do sleep 0.5; done; }

trivial() {
  fresh
  printf '%s\n[factor]\na = { sets = "m.a", levels = [%s] }\n[stage.formula]\nkind = "formula"\ndesign = "grid"\nmaterial = "base"\nresponses.y = { value = "2*a" }\n' "$head" "$(levels 10000)" >w.toml
  run >out
  # One "begun" for each task in the workers' reports.
  echo "trivial: 10,000 tasks in $(field out 'd["seconds"]') s, begun $(cat store/queue/*/worker-* | grep -c '"begun"'), ran $(field out 'd["tasks"]["ran"]')"
}
half() {
  fresh
  commands 400 'sleep 0.5'
  run >out
  echo "half: 400 x 0.5 s in $(field out 'd["seconds"]') s, computed $(done_of), squeue $(asked squeue)"
}
node() {
  fresh
  commands 400 'sleep 0.5'
  run >out &
  sleep 8
  for p in /proc/[0-9]*; do
    if tr "\0" "\n" 2>/dev/null <"$p/environ" | grep -qx SLURMD_NODENAME=n2; then kill -KILL "${p#/proc/}" 2>/dev/null; fi
  done
  wait
  echo "node: the workers of a node killed at 8 s: $(field out 'd["seconds"]') s, computed $(done_of) of 400"
}
submitter() {
  fresh
  commands 100 'sleep 0.5'
  "$flow" run w.toml --executor slurm --site site.toml >/dev/null 2>&1 &
  local pid=$!
  until_done 20
  kill -KILL $pid
  wait $pid 2>/dev/null
  local jobs
  jobs=$(asked sbatch)
  run >out
  echo "submitter: killed and followed: $(($(asked sbatch) - jobs)) jobs submitted, $(($(done_of) - 100)) tasks computed twice"
}
memory() {
  fresh
  commands 50 'sleep 0.2; [ $(cat in) = 17 ] \&\& head -c 900000000 /dev/zero | tail >/dev/null'
  sed -i 's/\\&/\&/g' w.toml
  run --keep-going >out
  echo "memory: $(field out 'd["tasks"]["ran"]') of 52 ran, failed $(field out 'd["tasks"]["failed"]'): $(grep -m1 '^error: rows' said)"
}
walltime() {
  fresh '1 min'
  sed -i 's/workers = 8/workers = 2/' site.toml
  commands 150 'sleep 1'
  run >out
  echo "walltime: $(field out 'd["seconds"]') s, failed $(field out 'd["tasks"]["failed"]'), submissions $(asked sbatch), computed $(done_of)"
}
leave() { # SIGNAL
  fresh
  commands 400 'sleep 0.5'
  "$flow" run w.toml --executor slurm --site site.toml >/dev/null 2>said &
  local pid=$!
  until_done 20
  kill -"$1" $pid
  wait $pid
}
ctrlc() {
  leave INT
  local since=$SECONDS
  settle
  echo "ctrlc: queue empty after $((SECONDS - since)) s, $(done_of) results kept"
}
hangup() {
  leave HUP
  local there
  there=$("$real" -h -o %i | wc -l)
  run >out
  echo "hangup: $there jobs went on; all $(field out 'd["tasks"]["total"]') tasks there after the same command, computed $(done_of)"
}

for step in "${@:-trivial half node submitter memory walltime ctrlc hangup}"; do
  for one in $step; do
    settle
    "$one"
  done
done
