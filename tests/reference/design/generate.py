"""Reference values for the designs, from programs that share nothing with ours.

Run with numpy 2.4.6, scipy 1.17.1, statsmodels 0.15.0, pyDOE3 1.6.2:  python3 generate.py
"""

import pathlib
from itertools import combinations, permutations

import numpy as np
import pyDOE3
import scipy
from scipy import stats
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


def power():
    """Upper tails of the non-central F distribution, and power of balanced one-way layouts."""
    with open(here / "power.csv", "w") as f:
        f.write(head("scipy.stats: alpha, df1, df2, lambda, F with upper tail alpha (f.isf), upper tail of ncf there"))
        for alpha in [0.05, 0.01]:
            for df1, df2 in [(1, 1), (1, 12), (2, 35), (3, 8), (2, 1000)]:
                for nc in [0.5, 4.0, 20.0, 80.0]:
                    c = stats.f.isf(alpha, df1, df2)
                    f.write(f"{alpha},{df1},{df2},{nc},{float(c)!r},{float(stats.ncf.sf(c, df1, df2, nc))!r}\n")


def discrepancy():
    """Centred L2 discrepancy of the first 16 Sobol points in 3 dimensions."""
    points = qmc.Sobol(3, scramble=False).random(16)
    print("CD:", repr(float(qmc.discrepancy(points, method="CD"))))


def surface():
    """Variance inflation and condition of second-order designs, with statsmodels."""
    from statsmodels.stats.outliers_influence import variance_inflation_factor

    def second_order(x):
        n, k = x.shape
        columns = [np.ones(n)] + [x[:, j] for j in range(k)] + [x[:, j] ** 2 for j in range(k)]
        return np.column_stack(columns + [x[:, a] * x[:, b] for a in range(k) for b in range(a + 1, k)])

    a = 2**0.5
    ccd = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1], [-a, 0], [a, 0], [0, -a], [0, a]] + [[0, 0]] * 5)
    bbd = pyDOE3.bbdesign(4, center=3)
    for name, x in [("ccd", ccd), ("bbd", bbd)]:
        m = second_order(x)
        vif = max(variance_inflation_factor(m, j) for j in range(1, m.shape[1]))
        print(name, "largest VIF", repr(float(vif)), "condition", repr(float(np.linalg.cond(m / np.linalg.norm(m, axis=0)))))


def word_lengths():
    """A3 of the generalized word-length pattern of published orthogonal arrays (Xu & Wu 2001)."""
    names = ["L8(2^7)", "L9(3^4)", "L12(2^11)", "L16(2^15)", "L16(4^5)", "L18(6^1 3^6)", "L25(5^6)", "L32(2^1 4^9)"]
    for name in names + ["L36(3^23)", "L50(2^1 5^11)", "L54(2^1 3^25)", "L64(4^21)", "L81(3^40)"]:
        a = pyDOE3.get_orthogonal_array(name).astype(int)
        n, k = a.shape
        cells = [np.unique(a[:, j], return_inverse=True)[1] for j in range(k)]
        s = [c.max() + 1 for c in cells]
        total = 0
        for x, y, z in combinations(range(k), 3):
            counts = np.bincount((cells[x] * s[y] + cells[y]) * s[z] + cells[z], minlength=s[x] * s[y] * s[z])
            total += (counts.astype(float) ** 2).sum() * len(counts) / n**2 - 1
        print(name, total)


sobol()
maximin()
word_lengths()
power()
discrepancy()
surface()
