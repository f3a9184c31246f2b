#!/usr/bin/env bash
# Installs what is missing to build, test and run Coif on Debian 12. Idempotent; quick the second time.
# Usage: scripts/setup.sh [--tests]   (--tests: also what only the tests need)
source "$(dirname "$0")/common.sh"

apt_install() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >>build/apt.log 2>&1
}

PACKAGES=(
  build-essential cmake ninja-build ccache git ca-certificates dpkg-dev
  python3 python3-dev python3-venv
  libeigen3-dev libopenmesh-dev libosd-dev libtinygltf-dev libtbb-dev libepoxy-dev libegl-dev libgl-dev
  libglfw3-dev libimgui-dev fonts-dejavu-core libegl1 libegl-mesa0 libgl1-mesa-dri libstb-dev libopenexr-dev libembree-dev
  liblz4-dev libcli11-dev nlohmann-json3-dev libgtest-dev libbenchmark-dev
)
missing=()
for package in "${PACKAGES[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  say "Installing ${missing[*]}"
  as_root apt-get update -qq
  apt_install "${missing[@]}" || { tail -20 build/apt.log; exit 1; }
fi

# libigl has no Debian library package. CMake fetches its upstream; where that cannot be reached, the headers
# inside the Debian source package of slic3r-prusa serve (see cmake/CoifDependencies.cmake).
enable_source_packages() {
  # The machine's own source entries, with the type changed.
  local entries
  entries=$(cat /etc/apt/sources.list.d/*.sources 2>/dev/null | sed 's/^Types:.*$/Types: deb-src/' || true)
  [ -z "$entries" ] || printf '%s\n' "$entries" | as_root tee /etc/apt/sources.list.d/coif-deb-src.sources >/dev/null
  entries=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null | sed -n 's/^deb /deb-src /p' || true)
  [ -z "$entries" ] || printf '%s\n' "$entries" | as_root tee /etc/apt/sources.list.d/coif-deb-src.list >/dev/null
  as_root apt-get update -qq
}
libigl_from_debian() {
  apt-get source --print-uris slic3r-prusa >/dev/null 2>&1 || enable_source_packages
  local work
  work=$(mktemp -d)
  (cd "$work" && apt-get source -qq --download-only slic3r-prusa >/dev/null 2>&1 &&
    tar xf slic3r-prusa_*.orig.tar.* --wildcards '*/src/libigl/*')
  mkdir -p .deps
  rm -rf .deps/libigl.new .deps/libigl
  cp -r "$work"/*/src/libigl .deps/libigl.new && mv .deps/libigl.new .deps/libigl
  rm -rf "$work"
}
if ! [ -e .deps/libigl/igl/AABB.h ] && ! [ -e /usr/include/igl/AABB.h ] && ! [ -e /usr/local/include/igl/AABB.h ]; then
  upstream=$(sed -n 's/.*GIT_REPOSITORY \([^ ]*\).*/\1/p' cmake/CoifDependencies.cmake)
  if GIT_TERMINAL_PROMPT=0 timeout 20 git ls-remote --exit-code "$upstream" HEAD >/dev/null 2>&1; then
    say "libigl: CMake will fetch it from its upstream"
  else
    say "libigl: upstream cannot be reached; taking the headers from Debian's slic3r-prusa source package"
    libigl_from_debian
  fi
fi

# Python tools in an environment of the project's own.
python_has() { "$VENV/bin/python" -c "import $1" >/dev/null 2>&1; }
[ -x "$VENV/bin/python" ] || { say "Creating the Python environment"; python3 -m venv "$VENV"; }
wheels=()
python_has nanobind || wheels+=(nanobind)
python_has numpy || wheels+=(numpy)
if [ "${1:-}" = --tests ]; then
  python_has pytest || wheels+=(pytest)
  python_has pxr || wheels+=(usd-core)
  python_has flip_evaluator || wheels+=(flip-evaluator)
  python_has PIL || wheels+=(pillow)
  python_has scikit_build_core || wheels+=(scikit-build-core)
fi
if [ ${#wheels[@]} -gt 0 ]; then
  say "Installing Python packages: ${wheels[*]}"
  "$VENV/bin/python" -m pip install -q --disable-pip-version-check "${wheels[@]}"
fi
[ "${1:-}" = --tests ] || exit 0

# The Khronos validator (Node) and Blender as a module judge the exports; tests skip with a message without them.
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
  say "Installing Node.js for the glTF validator"
  apt_install nodejs npm || true
fi
# The editor's tests drive a real window on a display of their own.
if ! command -v Xvfb >/dev/null || ! command -v xdotool >/dev/null; then
  say "Installing Xvfb and xdotool for the editor's tests"
  apt_install xvfb xdotool || true
fi
if ! [ -e build/node_modules/gltf-validator ] && command -v npm >/dev/null; then
  say "Installing gltf-validator"
  npm install --silent --no-audit --no-fund --prefix build gltf-validator@2.0.0-dev.3.10 >build/npm.log 2>&1 ||
    say "gltf-validator could not be installed; its tests will be skipped"
fi
if ! [ -e build/venv-blender/ready ]; then
  say "Installing Blender as a Python module (about 400 MB)"
  apt_install libx11-6 libxxf86vm1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libxrender1 || true
  { python3 -m venv build/venv-blender &&
    build/venv-blender/bin/python -m pip install -q --disable-pip-version-check bpy==5.0.1 &&
    build/venv-blender/bin/python -c 'import bpy' && touch build/venv-blender/ready; } >build/blender.log 2>&1 ||
    say "Blender could not be installed; its tests will be skipped"
fi
