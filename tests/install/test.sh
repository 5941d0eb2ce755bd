#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# test.sh BUILD_FOLDER: installs into an empty folder, builds a stranger's programs against it and runs them: on the
# host, inside an application's OpenCL queue, and inside an application's CUDA stream, on the stub of the driver and
# on the driver where there is one. All have to find the same pairs. Completion lies where shells look for it.
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

expected=$("$work/consumer/consumer")
echo "host: $expected"
same() { # same NAME PROGRAM: runs it, and each of its lines has to be the host's
  local out
  out=$("$2") || { echo "$1: failed" >&2; exit 1; }
  echo "$1: $(sort -u <<<"$out")"
  [ "$(sort -u <<<"$out")" = "$expected" ] || { echo "$1: the host says $expected" >&2; exit 1; }
}
same opencl "$work/consumer/embed_opencl"

stubs=$build/tests/stubs
LD_LIBRARY_PATH=$stubs/driver TANDEM_NVRTC=$stubs/nvrtc/libnvrtc.so "$work/consumer/embed_cuda"
if "$work/prefix/bin/tandem" devices | grep -q '^cuda:0'; then
  same cuda "$work/consumer/embed_cuda"
else
  echo "cuda: no driver here, so only its stub was asked"
fi
