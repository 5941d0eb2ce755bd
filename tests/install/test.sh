#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# test.sh BUILD_FOLDER: installs into an empty folder, then builds and runs users' programs against it: on the host, in
# an application's OpenCL queue, and in an application's CUDA stream (on the stub of the driver, and on the driver if
# there is one). All must find the same pairs. Also checks the installed shell completion and scripts.
set -euo pipefail
build=$(cd "$1" && pwd)
folder=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
# Libraries are those of the build, which may be outside the default search paths.
given=()
found() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }
for name in CMAKE_BUILD_RPATH CMAKE_INCLUDE_PATH CMAKE_LIBRARY_PATH OpenCL_INCLUDE_DIR OpenCL_LIBRARY ZLIB_INCLUDE_DIR \
  ZLIB_LIBRARY; do
  value=$(found "$name")
  if [ -n "$value" ]; then given+=("-D$name=$value"); fi
done
cmake -S "$folder" -B "$work/consumer" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix;$(found CMAKE_PREFIX_PATH)" "${given[@]}" \
  >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
cmake --build "$work/consumer" >"$work/log" || { cat "$work/log" >&2; exit 1; }
"$work/prefix/bin/tandem" scenes >/dev/null
"$work/prefix/bin/tandem" completion bash | cmp - "$work/prefix/share/bash-completion/completions/tandem"
"$work/prefix/bin/tandem" completion zsh | cmp - "$work/prefix/share/zsh/site-functions/_tandem"

# A Python subcommand, from the installed tree alone; without its files, one line explains the absence.
(
  cd "$work"
  "$work/prefix/bin/tandem" paper --device host -o paper --dry-run | grep ' cells-plates ' >/dev/null
  if [ -e prefix/libexec/tandem/javascript/three/three.min.js ]; then
    prefix/bin/tandem view plates --frames 0 -o page.html >/dev/null
    grep -q 'id="data-scene"' page.html
  fi
  mv prefix/libexec libexec
  status=0 && prefix/bin/tandem paper --device host -o paper --dry-run 2>errors || status=$?
  [ "$status" = 2 ] && [ "$(wc -l <errors)" = 1 ] && grep -q 'tandem paper is not part of this installation' errors
  mv libexec prefix/libexec
)

# The installed scripts work without the source tree on the given records and exports.
(
  cd "$work"
  records=$folder/../../results/cpu/walks.jsonl
  prefix/bin/tandem-tables "$records" | grep '^### pile:bodies=64' >/dev/null
  cp "$records" walks.jsonl
  prefix/bin/tandem-convert-records walks.jsonl >/dev/null
  cmp "$records" walks.jsonl
  if [ -e prefix/libexec/tandem/javascript/chart.js/chart.min.js ]; then
    prefix/bin/tandem report walks.jsonl -o report.html >/dev/null
    grep -q '>How it works: tiled<' report.html
  fi
  prefix/bin/tandem accuracy hard:touch:pairs=4,together=2 --device host --set k=8,18 --repeat 1 --truth-contacts 1 --quiet --out truth.jsonl >/dev/null
  prefix/bin/tandem-figures truth.jsonl drawn >/dev/null
  [ -s drawn/bars.svg ]
  sed 's/"schema":4/"schema":3/' walks.jsonl >old.jsonl
  status=0 && prefix/bin/tandem-tables old.jsonl 2>errors || status=$?
  [ "$status" = 2 ] && grep -q 'tandem-convert-records' errors
  if /usr/bin/python3 -c 'import numpy, PIL' 2>/dev/null; then
    prefix/bin/tandem export plates --frames 0 --glb plates.glb >/dev/null
    prefix/bin/tandem-render plates.glb plates --at 0 >/dev/null
    [ -s plates-0.png ]
  fi
)

# A program of one header, its output, and its build by pkg-config.
steps='step 0: 0 candidate pairs, 0 contacts
step 1: [1-9][0-9]* candidate pairs, [1-9][0-9]* contacts; the deepest is 0.050, of tetrahedra [0-4] and [0-4]
step 2: [1-9][0-9]* candidate pairs, [1-9][0-9]* contacts; the deepest is 0.150, of tetrahedra [0-4] and [0-4]'
collide=$("$work/consumer/collide")
[ "$(wc -l <<<"$collide")" = 3 ] && [ "$(grep -cxf <(echo "$steps") <<<"$collide")" = 3 ] || { echo "collide: $collide" >&2; exit 1; }
if command -v pkg-config >/dev/null && PKG_CONFIG_PATH=$work/prefix/lib/pkgconfig:$work/prefix/lib/x86_64-linux-gnu/pkgconfig && export PKG_CONFIG_PATH && pkg-config tandem; then
  # shellcheck disable=SC2046 # words of flags
  c++ -O1 -o "$work/collide" "$folder/../../scripts/examples/collide.cpp" $(pkg-config --cflags --libs tandem)
  [ "$("$work/collide")" = "$collide" ]
fi
distances=$("$work/consumer/distances")
[ "$distances" = "step 0: farther than 0.3
step 1: 0.265 from 1.000 0.000 0.000 to 1.250 0.063 0.063
step 2: 0.072 from 0.958 0.021 0.021 to 1.000 0.062 0.062
step 3: -0.072 from 0.792 0.104 0.104 to 0.750 0.063 0.063" ] || { echo "distances: $distances" >&2; exit 1; }
surfaces=$("$work/consumer/surfaces")
[ "$surfaces" = "step 0: no contact
step 1: 9 polygons, area 0.0622, force on the lower one -1139 -326 -2224
step 2: 9 polygons, area 0.5903, force on the lower one -18717 -8138 -89247
step 3: 21 polygons, area 2.1774, force on the lower one -57129 -26367 -342936" ] || { echo "surfaces: $surfaces" >&2; exit 1; }
[ -s "$work"/prefix/share/doc/tandem/LICENSE ]
[ -s "$work"/prefix/share/doc/tandem/NOTICE.md ]
# A component that this build has not is refused by name.
mkdir "$work/component" && printf 'cmake_minimum_required(VERSION 3.25)\nproject(c LANGUAGES CXX)\nfind_package(tandem REQUIRED COMPONENTS vulkan)\n' >"$work/component/CMakeLists.txt"
if cmake -S "$work/component" -B "$work/component/build" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix;$(found CMAKE_PREFIX_PATH)" "${given[@]}" >"$work/log" 2>&1; then
  echo "component vulkan was found" >&2; exit 1
fi
grep -q 'this tandem has no component vulkan' "$work/log" || { cat "$work/log" >&2; exit 1; }

expected=$("$work/consumer/consumer")
echo "host: $expected"
same() { # same NAME PROGRAM: runs it; each of its lines must equal the host's
  local out
  out=$("$2") || { echo "$1: failed" >&2; exit 1; }
  echo "$1: $(sort -u <<<"$out")"
  [ "$(sort -u <<<"$out")" = "$expected" ] || { echo "$1: expected $expected, as on the host" >&2; exit 1; }
}
same opencl "$work/consumer/opencl_queue"

stubs=$build/tests/stubs
LD_LIBRARY_PATH=$stubs/driver TANDEM_CUPTI= TANDEM_NVRTC=$stubs/nvrtc/libnvrtc.so "$work/consumer/cuda_stream"
LD_LIBRARY_PATH=$stubs/driver TANDEM_CUPTI= TANDEM_NVRTC=$stubs/nvrtc/libnvrtc.so "$work/consumer/graph_capture" plates 3
if "$work/prefix/bin/tandem" devices | grep '^cuda:0' >/dev/null; then
  same cuda "$work/consumer/cuda_stream"
  "$work/consumer/graph_capture"
else
  echo "cuda: no driver, only its stub was tested"
fi

# MPI ranks, if the build has MPI: any number of ranks finds as many pairs.
if [ -x "$work/consumer/ranks" ]; then
  launch=$(found MPIEXEC_EXECUTABLE)
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
  alone=$("$launch" -n 1 "$work/consumer/ranks" 2>"$work/errors") || { cat "$work/errors" >&2; exit 1; }
  grep -q '^frame 2: [1-9]' <<<"$alone" || { echo "ranks: no pairs" >&2; exit 1; }
  for ranks in 2 4; do
    together=$("$launch" -n $ranks "$work/consumer/ranks" 2>"$work/errors") || { cat "$work/errors" >&2; exit 1; }
    [ "$together" = "$alone" ] || { echo "ranks: $ranks ranks find $together, one rank finds $alone" >&2; exit 1; }
    grep -q "^frame 2, rank $((ranks - 1)): [1-9][0-9]* bodies, [1-9]" "$work/errors" || { cat "$work/errors" >&2; exit 1; }
  done
  echo "ranks: $(tail -1 <<<"$alone") on 1, 2 and 4"
fi
