#!/usr/bin/env python3
"""Draws time and memory against tolerance from `./isophote bench SCENE --json --tolerance ...`: chart.py BENCH.json SCENE > chart.svg"""
import json
import math
import sys

WIDTH, HEIGHT, LEFT, TOP, GAP = 860, 330, 62, 46, 92
PANEL = (WIDTH - LEFT - GAP - 20) / 2
BOTTOM = HEIGHT - 46
COLOURS = {"primary": "#1f6fb4", "bounce": "#d2691e", "room": "#2e8b57", "memory": "#6a4fa3"}


def panel(x0, title, unit, series, out):
    """series: name -> (direct, [(tolerance, triangles)])."""
    tolerances = sorted({t for _, points in series.values() for t, _ in points}, reverse=True)
    values = [v for direct, points in series.values() for v in [direct] + [p for _, p in points]]
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    x = lambda t: x0 + PANEL * (math.log10(tolerances[0]) - math.log10(t)) / (math.log10(tolerances[0]) - math.log10(tolerances[-1]))
    y = lambda v: BOTTOM - (BOTTOM - TOP) * (math.log10(v) - low) / (high - low)
    out.append(f'<text x="{x0}" y="{TOP - 22}" class="t">{title}</text>')
    for k in range(low, high + 1):
        out.append(f'<path d="M{x0} {y(10**k):.1f}h{PANEL}" class="g"/><text x="{x0 - 6}" y="{y(10**k) + 4:.1f}" class="e">{10**k:g}</text>')
    for t in tolerances:
        out.append(f'<text x="{x(t):.1f}" y="{BOTTOM + 17}" class="m">{t:.0e}</text>'.replace("e-0", "e-"))
    out.append(f'<text x="{x0 + PANEL / 2}" y="{BOTTOM + 35}" class="m">tolerance of the triangles, share of the diagonal</text>')
    out.append(f'<text x="{x0 - 6}" y="{TOP - 8}" class="e">{unit}</text>')
    for name, (direct, points) in series.items():
        line = " ".join(f"{x(t):.1f},{y(v):.1f}" for t, v in points)
        colour = COLOURS[name]
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2" stroke-dasharray="5 4"/>')
        out.append(f'<path d="M{x0} {y(direct):.1f}h{PANEL}" stroke="{colour}" stroke-width="2.5"/>')
        out.append(f'<text x="{x0 + PANEL - 4}" y="{y(direct) + 13:.1f}" text-anchor="end" fill="{colour}">{name}, exact</text>')


def main():
    with open(sys.argv[1]) as file:
        bench = json.load(file)
    rows = [r for r in bench["rows"] if r["scene"] == sys.argv[2]]
    times = {}
    for name in ("primary", "bounce", "room"):
        found = sorted((r for r in rows if r["rays"] == name), key=lambda r: -r["tolerance"])
        times[name] = (sorted(r["direct_ns"] for r in found)[len(found) // 2], [(r["tolerance"], r["triangles_ns"]) for r in found])
    found = sorted((r for r in rows if r["rays"] == "memory"), key=lambda r: -r["tolerance"])
    memory = {"memory": (found[0]["direct_bytes"] / 1e6, [(r["tolerance"], r["triangles_bytes"] / 1e6) for r in found])}
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">',
        "<style>.t{font-size:13px;font-weight:bold}.g{stroke:#ddd}.e{text-anchor:end;fill:#555}.m{text-anchor:middle;fill:#555}</style>",
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>',
    ]
    panel(LEFT, "Time of a ray (solid: exact; dashed: best triangles)", "ns", times, out)
    panel(LEFT + PANEL + GAP, "Memory (solid: exact; dashed: least triangles)", "MB", memory, out)
    out.append("</svg>")
    print("\n".join(out))


main()
