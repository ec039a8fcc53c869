#!/usr/bin/env bash
# The examples with YADE and LAMMPS, run for real: installs both.
set -euo pipefail
cd "$(dirname "$0")/../.."
export FLOW_TEST_ENGINES=1
.ci/install
cargo test --release --locked --test cli engines:: -- --nocapture
