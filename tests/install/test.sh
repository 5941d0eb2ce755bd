#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# test.sh BUILD_FOLDER: installs into an empty folder, builds a stranger's programs against it and runs them: on the
# host, inside an application's OpenCL queue, and inside an application's CUDA stream, on the stub of the driver and
# on the driver where there is one. All have to find the same pairs. Completion lies where shells look for it, and scripts
# that read records beside the program.
set -euo pipefail
build=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
# Libraries are where the build found them, which may be nowhere that a stranger would look.
given=()
found() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }
for name in CMAKE_BUILD_RPATH CMAKE_INCLUDE_PATH CMAKE_LIBRARY_PATH OpenCL_INCLUDE_DIR OpenCL_LIBRARY ZLIB_INCLUDE_DIR \
  ZLIB_LIBRARY; do
  value=$(found "$name")
  if [ -n "$value" ]; then given+=("-D$name=$value"); fi
done
cmake -S "$here" -B "$work/consumer" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix;$(found CMAKE_PREFIX_PATH)" "${given[@]}" \
  >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
cmake --build "$work/consumer" >"$work/log" || { cat "$work/log" >&2; exit 1; }
"$work/prefix/bin/tandem" scenes >/dev/null
"$work/prefix/bin/tandem" completion bash | cmp - "$work/prefix/share/bash-completion/completions/tandem"
"$work/prefix/bin/tandem" completion zsh | cmp - "$work/prefix/share/zsh/site-functions/_tandem"

# A subcommand in Python, from the installed tree alone; where it is missing one line says so.
(
  cd "$work"
  "$work/prefix/bin/tandem" paper --device host -o paper --dry-run | grep ' cells-plates ' >/dev/null
  if [ -e prefix/libexec/tandem/javascript/three/three.min.js ]; then
    prefix/bin/tandem view plates --frames 0 -o page.html >/dev/null
    grep -q 'id="data-scene"' page.html
  fi
  mv prefix/libexec libexec
  status=0 && prefix/bin/tandem paper --device host -o paper --dry-run 2>said || status=$?
  [ "$status" = 2 ] && [ "$(wc -l <said)" = 1 ] && grep -q 'tandem paper is not part of this installation' said
  mv libexec prefix/libexec
)

# Scripts beside the program, which need nothing else of the tree: what records and exports they are given, they read.
(
  cd "$work"
  records=$here/../../results/cpu/walks.jsonl
  prefix/bin/tandem-tables "$records" | grep '^### pile:bodies=64' >/dev/null
  cp "$records" walks.jsonl
  prefix/bin/tandem-convert-records walks.jsonl >/dev/null
  cmp "$records" walks.jsonl
  prefix/bin/tandem accuracy hard:touch:pairs=4,together=2 --device host --set k=8,18 --repeat 1 --truth-contacts 1 --quiet --out truth.jsonl >/dev/null
  prefix/bin/tandem-figures truth.jsonl drawn >/dev/null
  [ -s drawn/bars.svg ]
  sed 's/"schema":4/"schema":3/' walks.jsonl >old.jsonl
  status=0 && prefix/bin/tandem-tables old.jsonl 2>said || status=$?
  [ "$status" = 2 ] && grep -q 'tandem-convert-records' said
  if /usr/bin/python3 -c 'import numpy, PIL' 2>/dev/null; then
    prefix/bin/tandem export plates --frames 0 --glb plates.glb >/dev/null
    prefix/bin/tandem-render plates.glb plates --at 0 >/dev/null
    [ -s plates-0.png ]
  fi
)

expected=$("$work/consumer/consumer")
echo "host: $expected"
same() { # same NAME PROGRAM: runs it, and each of its lines has to be the host's
  local out
  out=$("$2") || { echo "$1: failed" >&2; exit 1; }
  echo "$1: $(sort -u <<<"$out")"
  [ "$(sort -u <<<"$out")" = "$expected" ] || { echo "$1: the host says $expected" >&2; exit 1; }
}
same opencl "$work/consumer/opencl_queue"

stubs=$build/tests/stubs
LD_LIBRARY_PATH=$stubs/driver TANDEM_CUPTI= TANDEM_NVRTC=$stubs/nvrtc/libnvrtc.so "$work/consumer/cuda_stream"
if "$work/prefix/bin/tandem" devices | grep '^cuda:0' >/dev/null; then
  same cuda "$work/consumer/cuda_stream"
else
  echo "cuda: no driver here, so only its stub was asked"
fi

# Ranks of MPI, where the build found one: as many pairs on any number.
if [ -x "$work/consumer/ranks" ]; then
  launch=$(found MPIEXEC_EXECUTABLE)
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
  alone=$("$launch" -n 1 "$work/consumer/ranks" 2>"$work/said") || { cat "$work/said" >&2; exit 1; }
  grep -q '^frame 2: [1-9]' <<<"$alone" || { echo "ranks: no pairs" >&2; exit 1; }
  for ranks in 2 4; do
    shared=$("$launch" -n $ranks "$work/consumer/ranks" 2>"$work/said") || { cat "$work/said" >&2; exit 1; }
    [ "$shared" = "$alone" ] || { echo "ranks: $ranks of them say $shared, one says $alone" >&2; exit 1; }
    grep -q "^frame 2, rank $((ranks - 1)): [1-9][0-9]* bodies, [1-9]" "$work/said" || { cat "$work/said" >&2; exit 1; }
  done
  echo "ranks: $(tail -1 <<<"$alone") on 1, 2 and 4"
fi
