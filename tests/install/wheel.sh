#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# wheel.sh: builds the wheel of the checkout with pip, for this processor only, and tests it alone: its Collider finds
# the pairs of two tetrahedra, and reports an unknown device.
set -euo pipefail
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PYTHONPATH=$PWD/.cache/python PIP_DISABLE_PIP_VERSION_CHECK=1
/usr/bin/python3 -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir "$work" \
  --config-settings=cmake.define.TANDEM_LEVELS=native --config-settings=build-dir=build/wheel .
/usr/bin/python3 -m zipfile -e "$work"/tandem-*-cp3*-linux_*.whl "$work/unpacked"
PYTHONPATH=$work/unpacked /usr/bin/python3 - <<'END'
import tandem
corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]
collider = tandem.Collider([corner, corner])
assert collider.pairs([[0, 0, 0, 1, 0, 0, 0], [0.5, 0, 0, 1, 0, 0, 0]]).tolist() == [[0, 0, 1, 0]]
try:
    tandem.Collider([corner], device="cuda:99")
except ValueError as error:
    print(error)
END
