#!/usr/bin/env bash
# Installs the build into a fresh prefix, then configures, builds and runs the consumer against it.
# Usage: run.sh BUILD_DIR
set -euo pipefail
build=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$build/consumer" && mkdir -p "$build/consumer"
log=$build/consumer/log
{
  cmake --install "$build" --prefix "$build/consumer/prefix"
  cmake -S "$here" -B "$build/consumer/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$build/consumer/prefix"
  cmake --build "$build/consumer/build"
} >"$log" 2>&1 || { cat "$log"; exit 1; }
"$build/consumer/build/consumer"
