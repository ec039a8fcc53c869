"""Ratios and ranks by numpy and scipy: writes agreement.toml.

    python3 agreement.py > agreement.toml

Values with ties on both sides, drawn here from a fixed seed and rounded.
"""
import numpy as np
import scipy
import scipy.stats as st

rng = np.random.default_rng(11)
x = np.round(np.exp(rng.normal(3, 0.5, 40)))
y = np.round(x * np.exp(rng.normal(0.02, 0.1, 40)), 1)
ratio = y / x
print(f'# Written by agreement.py with numpy {np.__version__}, scipy {scipy.__version__}.')
for name, values in [
    ('x', x),
    ('y', y),
    ('quartiles', np.quantile(ratio, [0.25, 0.5, 0.75])),
    ('extremes', [ratio.min(), ratio.max()]),
    ('mean_and_std', [ratio.mean(), ratio.std(ddof=1)]),
    ('spearman', [st.spearmanr(x, y).statistic]),
]:
    print(f"{name} = [{', '.join(repr(float(v)) for v in values)}]")
