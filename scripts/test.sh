#!/usr/bin/env bash
# Installs what is missing, builds, runs every test (ctest and pytest). Last line: "N passed, N failed".
source "$(dirname "$0")/common.sh"
scripts/setup.sh --tests
say "Building"
configure_and_build all

say "ctest"
rm -f build/ctest.xml build/pytest.xml
export COIF_BIN_DIR=$BUILD/bin COIF_TEST_OUT=$ROOT/build/test-out
mkdir -p "$COIF_TEST_OUT"
ctest --test-dir "$BUILD" -j "$(nproc)" --output-on-failure --output-junit "$ROOT/build/ctest.xml" || true

say "pytest"
PYTHONPATH=$BUILD/python NODE_PATH=$ROOT/build/node_modules \
  "$VENV/bin/python" -m pytest tests/python -q -rs --junitxml build/pytest.xml || true

"$VENV/bin/python" tools/count_tests.py build/ctest.xml build/pytest.xml
