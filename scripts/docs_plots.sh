#!/bin/bash
# The plots of docs/: runs the benches in full and copies what the pages show.
# Usage: scripts/docs_plots.sh [COIF [BENCH...]], of place, visibility, scattering and dynamics (all)
set -euo pipefail
cd "$(dirname "$0")/.."
coif=${1:-build/release/bin/coif}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
shift $(($# > 0 ? 1 : 0))
[ $# -gt 0 ] || set -- place visibility scattering dynamics
for bench in "$@"; do
  "$coif" bench "$bench" -o "$folder"
  for plot in $(grep -ho "plots/$bench-[a-z0-9-]*\.svg" docs/*.md | sort -u); do
    cp "$folder/$(basename "$plot")" "docs/$plot"
  done
done
