#!/usr/bin/env python3
"""Counts instructions and cache misses per ray with callgrind: counts.py PROGRAM [SCENE RAYS SIDE TOLERANCE] > counts.md

PROGRAM is build/bench/bin/isophote_bench; SIDE is direct, MEDIUM, HIGH or GRID. Without a case all of CASES. Only the tracing itself is
counted. Caches are simulated: 48 kB, 12 ways, and behind it 1 MB, 16 ways, with lines of 64 bytes.
"""
import os
import re
import subprocess
import sys
import tempfile

CASES = [(scene, rays, side, tolerance)
         for scene, sets, tolerance, build in [
             ("wavy-torus", "primary bounce room scattered", "1e-4", "MEDIUM"),
             ("small-torus", "bounce room", "1e-4", "MEDIUM"),
             ("rational-torus", "primary bounce", "1e-4", "MEDIUM"),
             ("plate", "primary bounce room", "1e-4", "HIGH"),
             ("linkrods", "primary bounce room", "1e-4", "HIGH"),
             ("hammer", "primary bounce room", "1e-4", "HIGH"),
             ("wavy-torus", "primary bounce room", "1e-6", "GRID")]
         for rays in sets.split() for side in (["direct", build] if tolerance == "1e-4" else [build])]

# The first that fits a function's name or library.
GROUPS = [("walk", r"libembree"),
          ("slab", r"::meet_packet\("),
          ("closed form", r"analytic|closed_form"),
          ("trim", r"[Tt]rim|Winding|MonotonePiece"),
          ("Newton", r"::solve<|to_native"),
          ("grazing", r"GrazingRay|Subdivision|roots_in_window|bernstein_form"),
          ("in and out", r"batches<|enter_part|enter_some|set_rays|trace_placed|::trace\(|::nearest|memcpy|memset"),
          ("callbacks", r"")]


def counts_of(program, scene, rays, side, tolerance):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "callgrind.out")
        run = subprocess.run(["valgrind", "--tool=callgrind", "--cache-sim=yes", "--D1=49152,12,64", "--LL=1048576,16,64",
                              "--toggle-collect=iso::bench::collected*", f"--callgrind-out-file={out}", program, scene, rays,
                              "--once", side, "--tolerance", tolerance], capture_output=True, text=True, check=True)
        count = int(re.search(r"(\d+) rays", run.stdout).group(1))
        listed = subprocess.run(["callgrind_annotate", "--auto=no", "--threshold=100", "--show=Ir,Dr,Dw,D1mr,D1mw,DLmr,DLmw", "--show-percs=no", out],
                                capture_output=True, text=True, check=True).stdout
    number = r"\s*([\d,.]+)"
    sums, groups = [0] * 7, {name: 0 for name, _ in GROUPS}
    for line in listed.splitlines():
        found = re.match(number * 7 + r"\s+(\S.*:.*)", line)
        if not found:
            continue
        values = [0 if v == "." else int(v.replace(",", "")) for v in found.groups()[:7]]
        sums = [a + b for a, b in zip(sums, values)]
        groups[next(name for name, pattern in GROUPS if re.search(pattern, found.group(8)))] += values[0]
    return count, sums, groups


def row(program, scene, rays, side, tolerance):
    count, (instructions, reads, writes, d1r, d1w, l2r, l2w), groups = counts_of(program, scene, rays, side, tolerance)
    per_ray = lambda n: n / count
    shares = [f"{100 * groups[name] / instructions:.0f}" for name, _ in GROUPS] if side == "direct" else ["100"] + [""] * (len(GROUPS) - 1)
    cells = [scene, rays, side if side == "direct" else f"{side} {tolerance}", f"{per_ray(instructions):.0f}",
             f"{per_ray(reads + writes):.0f}", f"{per_ray(d1r + d1w):.1f}", f"{per_ray(l2r + l2w):.1f}"] + shares
    print("| " + " | ".join(cells) + " |", flush=True)


def main():
    if len(sys.argv) not in (2, 6):
        sys.exit(__doc__)
    program, cases = sys.argv[1], [tuple(sys.argv[2:6])] if len(sys.argv) > 2 else CASES
    titles = ["scene", "rays", "side", "instructions", "loads and stores", "L1 misses", "L2 misses"] + [name + " %" for name, _ in GROUPS]
    print("| " + " | ".join(titles) + " |\n|" + "---|" * len(titles))
    for case in cases:
        row(program, *case)


main()
