#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# levels.sh LIBRARY: files compiled for some processors must not define functions that other files define as well,
# because the linker keeps one definition for all processors.
set -euo pipefail
members=$(ar t "$1" | grep '^host_v[0-9]' || true)
[ -n "$members" ] || { echo "levels: no files of higher levels in $1"; exit 0; }
shared=$(nm -A -C --defined-only "$1" | grep -E ':host_v[0-9]+_[0-9]+\.cpp\.o:' | grep -E ' [WV] ' || true)
[ -z "$shared" ] || { echo "levels: defined for all processors in a file for some:"; echo "$shared"; exit 1; } >&2
echo "levels: $(wc -l <<<"$members") files share no definition with other files"
