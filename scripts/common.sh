# Shared by the scripts: where things are, and how to say what is going on. Sourced, not run.
set -euo pipefail
ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
VENV=${COIF_VENV:-$ROOT/build/venv}
BUILD=$ROOT/build/release
cd "$ROOT"
mkdir -p build

say() { printf '\n== %s\n' "$*"; }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# configure_and_build TARGET...: the release preset, all cores, through ccache where there is one.
configure_and_build() {
  COIF_LAUNCHER=$(command -v ccache || true)
  export COIF_LAUNCHER
  cmake --preset release -DPython_EXECUTABLE="$VENV/bin/python" >"$ROOT/build/configure.log" 2>&1 ||
    { cat "$ROOT/build/configure.log"; return 1; }
  cmake --build --preset release --target "$@"
}
