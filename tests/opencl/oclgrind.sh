#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# oclgrind.sh PROGRAM: runs tiny scenes on Oclgrind with checks for data races, uninitialised memory and wrong API use.
# Fails on any line of its log, on a wrong answer, and without Oclgrind; it is skipped only on a system whose packages have none.
set -euo pipefail
program=$(readlink -f "$1")
driver=$(find /usr/lib -name 'liboclgrind-rt-icd.so*' 2>/dev/null | sort | head -n 1)
if [ -z "$driver" ]; then
  echo "oclgrind: its driver liboclgrind-rt-icd.so is not installed" >&2
  packaged() { [[ $(LC_ALL=C apt-cache policy "$1" 2>/dev/null) =~ Candidate:\ [^\(] ]]; }
  if packaged oclgrind || ! packaged g++; then exit 1; fi # without g++ the packages are not known
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# A row of 24 tetrahedra: 4 cubes of 6.
python3 - >bar.msh <<'EOF'
from itertools import permutations
points = [(i, j, k) for i in range(5) for j in range(2) for k in range(2)]
number = {p: n for n, p in enumerate(points, 1)}
tets = []
for cube in range(4):
    for order in permutations(range(3)):
        corner, tet = [cube, 0, 0], [number[(cube, 0, 0)]]
        for axis in order:
            corner[axis] += 1
            tet.append(number[tuple(corner)])
        tets.append(tet)
print("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d" % len(points))
print("\n".join("%d %d %d %d" % (number[p], *p) for p in points))
print("$EndNodes\n$Elements\n%d" % len(tets))
print("\n".join("%d 4 2 0 0 %d %d %d %d" % (n, *t) for n, t in enumerate(tets, 1)))
print("$EndElements")
EOF

export OCL_ICD_VENDORS=$driver OCLGRIND_DATA_RACES=1 OCLGRIND_UNINITIALIZED=1 OCLGRIND_CHECK_API=1
# Unoptimised: Oclgrind 21.10 lacks an intrinsic that remains after inlining.
export OCLGRIND_BUILD_OPTIONS=-cl-opt-disable
cells=0
# Small because Oclgrind scans all memory in every launch: bars that touch only at their ends, whose 30 pairs suffice
# for spills, refills and balancing, and buffers of exactly the answer's size.
group=8
small=(--set body_pair_capacity=64 --set pair_capacity=64 --set contact_capacity=256)
check() { # ARGUMENTS...
  export OCLGRIND_LOG=$work/log
  : >"$OCLGRIND_LOG"
  "$program" check --mesh bar.msh --mesh bar.msh --mesh bar.msh --pose "0 0 0 1 0 0 0" --pose "3.2 0.3 0.2 0.9 0.1 0.3 0" \
    --pose "-0.6 -0.3 0.5 0.5 0.5 0 0.7" --device opencl:0 --set group_size=$group --set work_items=$((2 * group)) "${small[@]}" "$@" \
    >"$work/out" || { cat "$work/out"; exit 1; }
  if [ -s "$OCLGRIND_LOG" ]; then
    echo "oclgrind reports errors for: $*" >&2
    head -n 40 "$OCLGRIND_LOG" >&2
    exit 1
  fi
  right=$(grep -c '^opencl:0 .* [1-9][0-9]* *0 *0 .* yes ' "$work/out") || { cat "$work/out"; exit 1; }
  cells=$((cells + right))
}

# One cell and one session per process: Oclgrind 21.10 keeps marks of freed buffers for the next buffer at their
# address. The cells of the long form repeat kernels that other cells run.
long() { [ -z "${TANDEM_LONG_FORM:-}" ] || check "$@"; }
chunked=(--algorithm chunked --set leaves=4)
check "${chunked[@]}" --preset grouped --set seed_threshold=1
check "${chunked[@]}" --preset published --set seed_threshold=1000
long "${chunked[@]}" --preset grouped --set seed_threshold=1000
long "${chunked[@]}" --preset published --set seed_threshold=1
check --algorithm chunked --preset grouped --set precision=double --set output=digest
long --algorithm chunked --preset grouped --set precision=double --set output=count
queues=(--algorithm gproximity --preset fair --set groups=3 --set initial_items=4 --set queue_capacity=64
        --set balance_group_size=8)
check "${queues[@]}" --set local_queue=12 --set balance=parallel
long "${queues[@]}" --set local_queue=12 --set balance=serial
check "${queues[@]}" --set k=26 --set broad=tight --set residency=published --set upload=queues --set full_exit=yes --set refill=no \
  --set local_queue=30 --set batch=2
# Groups of 64, a wave of AMD's GPUs: no barrier may be left out between work-items that a warp of 32 would run in step.
# Oclgrind runs work-items one after another, and reports accesses that no barrier orders.
group=64
check --algorithm tiled
check --algorithm leaf_query
check "${chunked[@]}" --preset grouped --set seed_threshold=1
long "${chunked[@]}" --preset paper --set seed_threshold=1
long --algorithm leaf_query --set tree=scene
long "${queues[@]/balance_group_size=8/balance_group_size=64}" --set local_queue=12 --set balance=parallel
"$program" devices | grep Oclgrind >/dev/null || { echo "these runs were not on Oclgrind" >&2; exit 1; }
least=8
if [ -n "${TANDEM_LONG_FORM:-}" ]; then least=15; fi
[ "$cells" -ge $least ] || { echo "only $cells cells ran" >&2; exit 1; }
echo "oclgrind: $cells cells without an error"
