#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# test.sh BUILD_FOLDER: installs into an empty folder, builds the consumer against it and runs it.
set -euo pipefail
build=$1
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$here" -B "$work/consumer" -G Ninja -DCMAKE_PREFIX_PATH="$work/prefix" >/dev/null
cmake --build "$work/consumer" >"$work/log" || { cat "$work/log" >&2; exit 1; }
"$work/consumer/consumer"
"$work/prefix/bin/tandem" scenes >/dev/null
