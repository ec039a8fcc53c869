"""Reference values for the designs, from programs that share nothing with ours.

Run with numpy 2.4.6, scipy 1.17.1, statsmodels 0.15.0:  python3 generate.py
"""

import pathlib
from itertools import permutations

import numpy as np
import scipy
from scipy.stats import qmc

here = pathlib.Path(__file__).parent


def head(text):
    return f"# {text}; numpy {np.__version__}, scipy {scipy.__version__}\n"


def sobol():
    """Points 0 to 15 and eight later ones of the unscrambled sequence in 64 dimensions."""
    points = qmc.Sobol(64, scramble=False).random(1024)
    rows = list(range(16)) + [31, 64, 100, 255, 256, 511, 777, 1023]
    with open(here / "sobol.csv", "w") as f:
        f.write(head("scipy.stats.qmc.Sobol(64, scramble=False): point number from 0, coordinates"))
        for i in rows:
            f.write(",".join([str(i)] + [repr(float(x)) for x in points[i]]) + "\n")


def maximin():
    """Prints, for 4 to 9 points in two dimensions, the best smallest squared distance over all Latin hypercubes."""
    for n in range(4, 10):
        best = 0
        for p in permutations(range(n)):
            best = max(best, min((i - j) ** 2 + (p[i] - p[j]) ** 2 for i in range(n) for j in range(i)))
        print(n, best)


sobol()
maximin()
