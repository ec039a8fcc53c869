"""Responses that have almost all their digits in common: analysis of variance and regression in exact rational numbers.

    python3 close.py > close.toml

Each set is `lead` plus small offsets. A double near the lead is a rational number, so the sums of squares of the doubles that
are written down have exact values: those of the lead do not depend on it, for squares are taken about the mean.
"""
from fractions import Fraction as Q

OFFSETS = [[0.5, -1.0, 0.25, 1.125], [1.5, 2.0, 0.75, -0.5], [-2.0, -1.25, 0.0, 0.125]]


def solve(a, b):
    """Gaussian elimination in rational numbers."""
    n = len(a)
    rows = [list(r) + [v] for r, v in zip(a, b)]
    for i in range(n):
        pivot = next(r for r in range(i, n) if rows[r][i] != 0)
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [v / rows[i][i] for v in rows[i]]
        for r in range(n):
            if r != i:
                rows[r] = [v - rows[r][i] * w for v, w in zip(rows[r], rows[i])]
    return [r[-1] for r in rows]


def anova(cells):
    values = [v for cell in cells for v in cell]
    mean = sum(values) / len(values)
    means = [sum(cell) / len(cell) for cell in cells]
    between = sum(len(cell) * (m - mean) ** 2 for cell, m in zip(cells, means))
    within = sum((v - m) ** 2 for cell, m in zip(cells, means) for v in cell)
    df = [len(cells) - 1, len(values) - len(cells)]
    return between, within, between / df[0] / (within / df[1])


def regression(cells):
    """y = a + b·level + c·index, with levels and indexes from 0."""
    rows = [(Q(1), Q(i), Q(j), v) for i, cell in enumerate(cells) for j, v in enumerate(cell)]
    x, y = [r[:3] for r in rows], [r[3] for r in rows]
    normal = [[sum(r[i] * r[j] for r in x) for j in range(3)] for i in range(3)]
    b = solve(normal, [sum(r[i] * v for r, v in zip(x, y)) for i in range(3)])
    left = sum((v - sum(p * q for p, q in zip(r, b))) ** 2 for r, v in zip(x, y))
    mean = sum(y) / len(y)
    total = sum((v - mean) ** 2 for v in y)
    return b, left, (total - left) / 2 / (left / (len(y) - 3))


print('# Written by close.py.')
for lead in (1e15, -1e15, 3e12, 1.0):
    doubles = [[lead + offset for offset in cell] for cell in OFFSETS]
    cells = [[Q(v) for v in cell] for cell in doubles]
    between, within, f = anova(cells)
    b, left, f_model = regression(cells)
    print('[[set]]')
    print(f'lead = {lead!r}')
    print(f'cells = {doubles!r}')
    print(f'ss = [{float(between)!r}, {float(within)!r}]')
    print(f'f = {float(f)!r}')
    print(f'slopes = [{float(b[1])!r}, {float(b[2])!r}]')
    print(f'left = {float(left)!r}')
    print(f'f_model = {float(f_model)!r}')
