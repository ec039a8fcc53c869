#!/usr/bin/env bash
# What takes too long for every landing: kills at random moments, flips of random bytes, many mutated inputs.
#
#   tests/nightly/store.sh [KILLS] [FLIPS] [INPUTS]       1000 1000 1000000
#
# Prints how many were tried. The first that ends wrong ends the script.
set -euo pipefail
cd "$(dirname "$0")/../.."
kills=${1:-1000} flips=${2:-1000} inputs=${3:-1000000}
FLOW_TEST_KILLS=$kills cargo test --release --test cli kill:: -- --nocapture
FLOW_TEST_FLIPS=$flips cargo test --release --test cli trust::flips -- --nocapture
FLOW_FUZZ=$inputs cargo test --release --lib store::tests::fuzz -- --nocapture
FLOW_FUZZ=$inputs cargo test --release --test workflows texts -- --nocapture
FLOW_FUZZ=$inputs cargo test --release --test workflows bytes -- --nocapture
FLOW_FUZZ=$inputs cargo test --release --test workflows fuzz:: -- --nocapture
