#!/usr/bin/env bash
# Makes the pictures of the documentation anew: docs/pictures/*.png from the ready hairstyles and the examples. A few
# minutes on two cores.
source "$(dirname "$0")/common.sh"
[ -d "$BUILD/python/coif" ] && [ -x "$BUILD/bin/coif" ] || { scripts/setup.sh && configure_and_build coif coif_python; }
mkdir -p docs/pictures build/pictures
"$BUILD/bin/coif" -q example-head -o build/pictures/head.obj
for style in bob long bun mohawk pixie; do
  say "$style"
  "$BUILD/bin/coif" -q new --scalp build/pictures/head.obj --meters-per-unit 0.01 --style $style -o build/pictures/$style.coif
  "$BUILD/bin/coif" -q render build/pictures/$style.coif -o docs/pictures/style-$style.png --strands 60000 --size 340x340
done
say "draping"
"$BUILD/bin/coif" -q drape build/pictures/long.coif -o build/pictures/draped.coif --seconds 4 --droop 2
"$BUILD/bin/coif" -q render build/pictures/long.coif -o docs/pictures/drape-before.png --strands 15000 --size 300x300
"$BUILD/bin/coif" -q render build/pictures/draped.coif -o docs/pictures/drape-after.png --strands 15000 --size 300x300
say "wind"
for kind in columns:0 wisps:120; do
  "$BUILD/bin/coif" -q render build/pictures/long.coif -o build/pictures/motion-${kind%:*}.png --frames 24-24 --strands 15000 \
    --size 300x300 --wisps ${kind#*:} --wind constant --set windVelocity=6,0,0
  mv build/pictures/motion-${kind%:*}_0024.png docs/pictures/motion-${kind%:*}.png
done
for example in examples/[0-9]*.py; do
  say "$example"
  PYTHONPATH=$BUILD/python "$VENV/bin/python" "$example" -o build/pictures --size "${SIZE:-250}"
done
cp build/pictures/*.png docs/pictures/
say "path traced"
PYTHONPATH=$BUILD/python "$VENV/bin/python" scripts/picture_path_traced.py build/pictures/bob.coif build/pictures/head.obj \
  -o docs/pictures/path-traced.png --size 160 --samples 160 --strands 60000
for picture in docs/pictures/*.png; do
  bytes=$(stat -c %s "$picture")
  [ "$bytes" -le 204800 ] || { say "$picture has $bytes bytes: more than 200 KB; run with a smaller SIZE"; exit 1; }
done
