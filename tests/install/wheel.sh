#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# wheel.sh: builds the wheel of the checkout with pip, for this processor only and without MPI and Embree. auditwheel puts GMP, oneTBB
# and fmt into it, with their licences, and gives it a manylinux tag; OpenCL's loader stays the machine's own. Then installs it in an
# empty virtual environment, where its Collider finds the pairs of two tetrahedra and reports an unknown device. Needs PyPI.
set -euo pipefail
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
/usr/bin/python3 -m venv "$work/tools"
"$work/tools/bin/pip" install --quiet -r tests/install/wheel-requirements.txt
PYTHONPATH=$PWD/.cache/python /usr/bin/python3 -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir "$work" \
  --config-settings=cmake.define.TANDEM_LEVELS=native --config-settings=cmake.define.TANDEM_MPI=OFF \
  --config-settings=cmake.define.CMAKE_DISABLE_FIND_PACKAGE_embree=ON --config-settings=build-dir=build/wheel .

# Licences of what auditwheel bundles, from Debian's packages.
"$work/tools/bin/wheel" unpack --dest "$work/unpacked" "$work"/tandem_bvh-*.whl
tree=$(echo "$work"/unpacked/*)
for package in libgmp10 libtbb12 libfmt9; do
  install -D -m 644 "/usr/share/doc/$package/copyright" "$(echo "$tree"/*.dist-info)/licenses/$package"
done
mkdir "$work/licensed"
"$work/tools/bin/wheel" pack --dest-dir "$work/licensed" "$tree" >/dev/null
PATH=$work/tools/bin:$PATH "$work/tools/bin/auditwheel" repair --exclude libOpenCL.so.1 --wheel-dir "$work/repaired" "$work"/licensed/*.whl
wheel=$(echo "$work"/repaired/*.whl)
echo "$(basename "$wheel"): $(stat -c %s "$wheel") bytes"
listing=$(/usr/bin/python3 -m zipfile -l "$wheel")
grep -E '\.libs/|licenses/|_core' <<<"$listing"
for library in gmp tbb fmt; do grep -q "\.libs/lib$library" <<<"$listing"; done
if grep -E 'libOpenCL|libmpi|libembree' <<<"$listing"; then echo "wheel.sh: must not be bundled" >&2; exit 1; fi

/usr/bin/python3 -m venv "$work/empty"
"$work/empty/bin/pip" install --quiet "$wheel"
cd "$work"
"$work/empty/bin/python" - <<'END'
import tandem
corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]]
collider = tandem.Collider([corner, corner])
poses = [[0, 0, 0, 1, 0, 0, 0], [0.5, 0, 0, 1, 0, 0, 0]]
assert collider.pairs(poses).tolist() == [[0, 0, 1, 0]]
assert collider.meeting(poses).tolist() == [[0, 0, 1, 0]]
try:
    tandem.Collider([corner], device="cuda:99")
    raise SystemExit("device cuda:99 was accepted")
except ValueError as error:
    print(error)
END
