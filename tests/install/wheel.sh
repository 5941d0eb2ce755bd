#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# wheel.sh: builds the wheel of the checkout with pip, and prints the time. auditwheel puts GMP, oneTBB, fmt, lz4 and liblzma into it
# and gives it a manylinux tag; OpenCL's loader stays the machine's own. The licences of all bundled libraries are added. Then
# installs it in an empty virtual environment, where its Collider finds the pairs of two tetrahedra, and reports a k without host
# kernels and an unknown device. Needs PyPI, and Debian for the licences.
set -euo pipefail
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
/usr/bin/python3 -m venv "$work/tools"
"$work/tools/bin/pip" install --quiet -r tests/install/wheel-requirements.txt
TIMEFORMAT="compiled in %0R s, with %0U + %0S s of processor time"
time PYTHONPATH=$PWD/.cache/python /usr/bin/python3 -m pip wheel --verbose --no-deps --no-build-isolation --wheel-dir "$work" \
  --config-settings=build-dir=build/wheel . &>"$work/log" ||
  { cat "$work/log" >&2; exit 1; }
grep 'compiling the library takes about' "$work/log"

PATH=$work/tools/bin:$PATH "$work/tools/bin/auditwheel" repair --exclude libOpenCL.so.1 --wheel-dir "$work/repaired" "$work"/tandem_bvh-*.whl

# The copyright file of each bundled library's Debian package, and the licences that these files name.
"$work/tools/bin/wheel" unpack --dest "$work/unpacked" "$work"/repaired/*.whl >/dev/null
tree=$(echo "$work"/unpacked/*)
licences=$(echo "$tree"/*.dist-info)/licenses
for library in "$tree"/*.libs/*; do
  name=$(sed -E 's/-[0-9a-f]{8}\././' <<<"${library##*/}") # as before auditwheel
  package=$(dpkg --search "*/$name" | sed -n '1s/:.*//p')
  install -D -m 644 "/usr/share/doc/$package/copyright" "$licences/$package"
  grep -oE '/usr/share/common-licenses/[A-Z][A-Za-z0-9.-]*[0-9]' "$licences/$package" || true
done | sort -u | xargs install -m 644 -t "$licences"
mkdir "$work/licensed"
"$work/tools/bin/wheel" pack --dest-dir "$work/licensed" "$tree" >/dev/null
wheel=$(echo "$work"/licensed/*.whl)
echo "$(basename "$wheel"): $(stat -c %s "$wheel") bytes"
[[ $wheel == *-manylinux_* ]]
listing=$(/usr/bin/python3 -m zipfile -l "$wheel")
grep -E '\.libs/|licenses/|_core' <<<"$listing"
for library in gmp tbb fmt lz4 lzma; do grep -q "\.libs/lib$library" <<<"$listing"; done
for licence in libgmp10 libtbb12 libfmt9 liblz4-1 liblzma5 LGPL-3 Apache-2.0; do grep -q "licenses/$licence " <<<"$listing"; done
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
assert tandem.Collider([corner, corner], precision="double").pairs(poses).tolist() == [[0, 0, 1, 0]]
try:
    tandem.Collider([corner, corner], k=8).run(poses)
    raise SystemExit("k=8 was accepted")
except tandem.DeviceError as error:
    print(error)
    assert "this build has k = 18;" in str(error) and "TANDEM_HOST_K" in str(error) and "\n" not in str(error)
try:
    tandem.Collider([corner], device="cuda:99")
    raise SystemExit("device cuda:99 was accepted")
except ValueError as error:
    print(error)
END
