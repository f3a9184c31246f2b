#!/bin/bash
# usage: tests/fuzz/run.sh BIN_DIR DATA_DIR WORK_DIR [SECONDS]
# Makes seed corpora in WORK_DIR from the shared data (and from the small files of the tests' formats below), then runs
# every fuzzer of BIN_DIR for SECONDS (default 120) each, under a memory limit of 2.5 GiB with the sanitizers' own share.
set -u
bin=$1 data=$2 work=$3 seconds=${4:-120}
seed() {  # NAME PATTERN...: files of at most 64 KiB
  local name=$1
  shift
  mkdir -p "$work/$name"
  for pattern in "$@"; do
    find "$data" -type f -name "$pattern" -size -64k -exec cp --backup=numbered -t "$work/$name" {} +
  done
}
seed obj '*.obj'
seed gltf_mesh '*.gltf' '*.glb'
seed gltf_strands '*.gltf' '*.glb'
seed hair '*.hair'
if [ -x "$bin/test_io" ]; then  # strands that Coif writes: only those reach the reader's depths
  mkdir -p "$work/made" "$work/gltf_strands"
  COIF_TEST_OUT="$work/made" "$bin/test_io" --gtest_filter='GltfFiles.*' >"$work/made.log" 2>&1
  find "$work/made" -name '*.gl*' -size -64k -exec cp -t "$work/gltf_strands" {} +
fi
seed usd_mesh '*.usd*'
seed usd_strands '*.usd*'
seed usd_skin '*.usd*'
mkdir -p "$work"/{ply,off,stl,scene}
cp "$(dirname "$0")"/../scene/files/*.coif "$work/scene"
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n' >"$work/ply/text"
for order in little big; do
  printf 'ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty char x\nproperty short y\nproperty uchar z\nelement face 1\nproperty list uchar uchar vertex_index\nproperty list uchar float texcoord\nend_header\n\1\0\0\2\2\0\3\3\3\0\0\4\3\0\1\2\0' "$order" >"$work/ply/$order"
done
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n5 0 1 2 -1 0\n' >"$work/ply/strips"
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n' >"$work/off/plain"
printf 'STCNOFF # x\n3 1 0\n0 0 0 0 0 1 1 1 1 1 .5 .5\n1 0 0 0 0 1 1 1 1 1 0 1\n0 1 0 0 0 1 1 1 1 1 1 0\n3 0 1 2\n' >"$work/off/full"
printf 'solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n' >"$work/stl/text"
{ head -c 80 /dev/zero; printf '\1\0\0\0'; head -c 50 /dev/zero; } >"$work/stl/binary"
failed=0
for program in "$bin"/fuzz_*; do
  name=$(basename "$program" | sed s/fuzz_//)
  mkdir -p "$work/$name" "$work/found"
  if "$program" "$work/$name" -max_total_time="$seconds" -rss_limit_mb=2560 -timeout=10 -max_len=65536 \
    -artifact_prefix="$work/found/$name-" >"$work/$name.log" 2>&1; then
    echo "$name: $(grep -c . "$work/$name.log") lines of log, $(grep 'stat::number_of_executed_units\|DONE' "$work/$name.log" | tail -1)"
  else
    echo "$name: FAILED, see $work/$name.log"
    failed=1
  fi
done
exit $failed
