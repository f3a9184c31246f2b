#!/bin/bash
# The plots of docs/: runs the benches in full and copies what the pages show. Usage: scripts/docs_plots.sh [COIF]
set -euo pipefail
cd "$(dirname "$0")/.."
coif=${1:-build/release/bin/coif}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for page in visibility scattering; do
  "$coif" bench "$page" -o "$folder"
  for plot in $(grep -ho "plots/$page-[a-z0-9-]*\.svg" docs/visibility.md docs/light.md | sort -u); do
    cp "$folder/$(basename "$plot")" "docs/$plot"
  done
done
