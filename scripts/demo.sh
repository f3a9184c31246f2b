#!/usr/bin/env bash
# From nothing to a hairstyle: installs what is missing, builds, models a bob on a generated head and exports it
# to out/bob.usdc, out/bob.glb, out/bob.hair with a picture, out/bob.png.
source "$(dirname "$0")/common.sh"
scripts/setup.sh
say "Building"
configure_and_build coif

say "A bob on the example head"
mkdir -p out
COIF=$BUILD/bin/coif
"$COIF" example-head -o out/head.obj
"$COIF" new --scalp out/head.obj --meters-per-unit 0.01 --style bob -o out/bob.coif
"$COIF" build out/bob.coif -o out/bob.usdc -o out/bob.glb -o out/bob.hair --strands 100000 --explain --report out/bob.report.json
"$COIF" render out/bob.coif -o out/bob.png --size 1024x1024 --strands 100000
say "Wrote out/bob.usdc, out/bob.glb, out/bob.hair, out/bob.png"
