"""The colours of figures, and how far apart colours are for people who see no red or no green."""
import itertools
import pathlib
import re

STYLE = pathlib.Path(__file__).parents[2] / "lib/accdec/plot/figure_style.hpp"
# Those of series, in their order.
SERIES = re.findall(r"#[0-9a-f]{6}", re.search(r"colours\{(.*?)\};", STYLE.read_text(), re.S)[1])

# Machado, Oliveira, Fernandes: A Physiologically-based Model for Simulation of Color Vision Deficiency, 2009; the
# matrices of the whole loss, for linear RGB.
EYES = {
    "all cones": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "protanopia": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "deuteranopia": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
}


def linear(part):
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4


def lab(colour, eye):
    """CIE L*a*b* of "#rrggbb" as that eye sees it."""
    rgb = [linear(int(colour[i:i + 2], 16) / 255) for i in (1, 3, 5)]
    r, g, b = (min(1, max(0, sum(m * c for m, c in zip(row, rgb)))) for row in EYES[eye])
    white = (0.95047, 1.0, 1.08883)
    xyz = (0.4124564 * r + 0.3575761 * g + 0.1804375 * b, 0.2126729 * r + 0.7151522 * g + 0.0721750 * b,
           0.0193339 * r + 0.1191920 * g + 0.9503041 * b)
    x, y, z = (t ** (1 / 3) if t > 0.008856 else 7.787 * t + 16 / 116 for t in (v / w for v, w in zip(xyz, white)))
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def nearest(colours):
    """(distance in L*a*b*, colour, colour, eye) of the two that differ least."""
    return min((sum((p - q) ** 2 for p, q in zip(lab(a, eye), lab(b, eye))) ** 0.5, a, b, eye)
               for eye in EYES for a, b in itertools.combinations(colours, 2))
