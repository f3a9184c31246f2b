#!/usr/bin/env bash
# Makes the pictures of the documentation anew: docs/pictures/*.png from the examples. A minute or two on two cores.
source "$(dirname "$0")/common.sh"
[ -d "$BUILD/python/coif" ] || { scripts/setup.sh && configure_and_build coif_python; }
mkdir -p docs/pictures build/pictures
for example in examples/[0-9]*.py; do
  say "$example"
  PYTHONPATH=$BUILD/python "$VENV/bin/python" "$example" -o build/pictures --size "${SIZE:-250}"
done
cp build/pictures/*.png docs/pictures/
for picture in docs/pictures/*.png; do
  bytes=$(stat -c %s "$picture")
  [ "$bytes" -le 204800 ] || { say "$picture has $bytes bytes: more than 200 KB; run with a smaller SIZE"; exit 1; }
done
