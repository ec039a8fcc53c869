#!/usr/bin/env bash
# Measures flow on a real Slurm, by hand: bash tests/cluster/measure.sh [STEP…]
#
# Wanted: sbatch, squeue and scancel in PATH (SLURM_CONF set, if that is not the system's), nodes with 8 CPUs in all, whose
# processes this machine can see, as of a Slurm with several slurmd on one machine; and a release build. FLOW names the program.
# The step `share` wants moto_server and rclone. Each step prints one line or a few; without steps all are measured:
#   trivial     10,000 tasks that take nothing
#   half        400 tasks of 0.5 s
#   node        the same, the workers of one node killed at 8 s
#   submitter   killed in the middle, and the same command again
#   memory      one of 50 tasks takes more than a worker has
#   walltime    workers that live shorter than the campaign
#   ctrlc       Ctrl-C: when the queue is empty
#   hangup      the terminal ends: the jobs go on
#   accounting  whether there is a database of jobs, and how often squeue was asked in a run of two minutes
#   size        memory of the submitter and of a worker, 100,000 tasks
#   share       push and pull of 10,000 results through two servers that speak S3
#   quick       c30, profile quick: workers of Slurm against one process
set -uo pipefail
cd "$(dirname "$0")/../.."
repo=$PWD
flow=${FLOW:-$repo/target/release/flow}
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

accounting() {
  fresh
  commands 480 'sleep 2'
  run >out
  local type
  type=$(scontrol show config | sed -n 's/^AccountingStorageType *= *//p')
  echo "accounting: $type: 480 x 2 s in $(field out 'd["seconds"]') s, computed $(done_of), squeue $(asked squeue)"
}
size() {
  fresh
  local half
  half=$(levels 316)
  printf '%s\n[factor]\na = { sets = "m.a", levels = [%s] }\nb = { sets = "m.b", levels = [%s] }\n[stage.formula]\nkind = "formula"\ndesign = "grid"\nmaterial = "base"\nresponses.y = { value = "a + 1000*b" }\n' \
    "$(echo "$head" | sed 's/m = { a = 1 }/m = { a = 1, b = 1 }/; s/factors = \["a"\]/factors = ["a", "b"]/')" "$half" "$half" >w.toml
  /usr/bin/time -f %M -o kilobytes "$flow" run w.toml --executor slurm --site site.toml --json 2>said >out &
  local peak=0 now
  while kill -0 $! 2>/dev/null; do
    now=$(ps -C "$(basename "$flow")" -o rss=,args= | awk '/ work / && $1 > m { m = $1 } END { print m + 0 }')
    [ "$now" -gt $peak ] && peak=$now
    sleep 1
  done
  echo "size: $(field out 'd["tasks"]["total"]') tasks in $(field out 'd["seconds"]') s: submitter $(($(cat kilobytes) / 1000)) MB, a worker at most $((peak / 1000)) MB"
}
clock() { python3 -c 'import time; print(time.time())'; }
passed() { python3 -c 'import sys, time; print(f"{time.time() - float(sys.argv[1]):.1f}")' "$1"; }
share() {
  fresh
  printf '%s\n[factor]\na = { sets = "m.a", levels = [%s] }\n[stage.formula]\nkind = "formula"\ndesign = "grid"\nmaterial = "base"\nresponses.y = { value = "2*a" }\n' "$head" "$(levels 10000)" >w.toml
  "$flow" run w.toml --quiet --store ours
  export AWS_ACCESS_KEY_ID=KEY AWS_SECRET_ACCESS_KEY=secret
  local server port=39471 at requests
  for server in moto rclone; do
    mkdir -p "served-$server/lab"
    case $server in
      moto) moto_server -H 127.0.0.1 -p $port >$server.log 2>&1 & ;;
      rclone) rclone serve s3 --auth-key KEY,secret --addr 127.0.0.1:$port -vv "served-$server" >$server.log 2>&1 & ;;
    esac
    local pid=$!
    until (: <"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do sleep 0.2; done
    export AWS_ENDPOINT_URL=http://127.0.0.1:$port
    [ $server = moto ] && python3 - $port <<'PY'
import sys, urllib.request
head = {"authorization": "AWS4-HMAC-SHA256 Credential=KEY/20260101/us-east-1/s3/aws4_request, SignedHeaders=host, Signature=0"}
urllib.request.urlopen(urllib.request.Request(f"http://127.0.0.1:{sys.argv[1]}/lab", method="PUT", headers=head))
PY
    at=$(clock); "$flow" store push s3://lab/group --unsigned --store ours >/dev/null; local push; push=$(passed "$at")
    count() { case $server in moto) grep -c ' HTTP/1.1' $server.log ;; rclone) grep -cE '(GET|PUT|HEAD) /' $server.log ;; esac; }
    requests=$(count)
    at=$(clock); "$flow" store push s3://lab/group --unsigned --store ours >/dev/null; local again; again=$(passed "$at")
    local second=$(($(count) - requests))
    at=$(clock); "$flow" store pull s3://lab/group --unsigned --store "theirs-$server" >pulled
    echo "share: $server: push $push s, second push $again s with $second requests, pull $(passed "$at") s: $(head -1 pulled)"
    kill $pid
    wait $pid 2>/dev/null
    port=$((port + 1))
  done
  unset AWS_ENDPOINT_URL
}
quick() {
  fresh
  sed -i '/here = false/d; /stage.formula/d; s/memory = .*/memory = "900 MB"/' site.toml
  local folder
  folder=$repo/workflows
  "$flow" run "$folder/c30.toml" --profile quick --store one --json >one.json 2>/dev/null
  "$flow" run "$folder/c30.toml" --profile quick --store many --executor slurm --site site.toml --json >many.json 2>said
  python3 - <<'PY'
import json
one, many = (json.loads(open(f).read().splitlines()[-1]) for f in ("one.json", "many.json"))
same = [s["object"] for s in one["stages"]] == [s["object"] for s in many["stages"]]
print(f"quick: one process {one['seconds']:.1f} s, Slurm {many['seconds']:.1f} s, ratio {one['seconds'] / many['seconds']:.2f}, same hashes: {same}")
PY
}

for step in "${@:-trivial half node submitter memory walltime ctrlc hangup accounting size share quick}"; do
  for one in $step; do
    settle
    "$one"
  done
done
