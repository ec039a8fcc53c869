"""Values of other programs for what has no certified data: writes other_code.toml.

    python3 other_code.py > other_code.toml

statsmodels: types I to III on unbalanced data, weighted fits, coefficients with errors, leverage, studentized residuals,
Cook's distance, PRESS, variance inflation, prediction intervals. numpy: canonical analysis. scipy: lack of fit and Lenth's
limits by their formulas. The data are the printed Tables 9 to 11 of Su et al. 2021, the filtration-rate experiment of
Montgomery (Design and Analysis of Experiments, example 6.2), and small tables drawn here from a fixed seed.
"""
import itertools
import pathlib
import sys
import warnings

import numpy as np
import pandas as pd
import scipy
import scipy.stats as st
import statsmodels
import statsmodels.api as sm
import statsmodels.formula.api as smf
from statsmodels.stats.anova import anova_lm
from statsmodels.stats.outliers_influence import variance_inflation_factor

warnings.filterwarnings('ignore')
DATA = pathlib.Path(__file__).parents[3] / 'workflows/su2021'


def put(name, value):
    if isinstance(value, (list, tuple, np.ndarray)):
        print(f'{name} = [' + ', '.join(f'"{v}"' if isinstance(v, str) else repr(float(v)) for v in value) + ']')
    else:
        print(f'{name} = ' + (f'"{value}"' if isinstance(value, str) else repr(float(value))))


def unbalanced():
    rng = np.random.default_rng(20210326)
    n = 37
    d = pd.DataFrame({'a': rng.integers(1, 4, n), 'b': rng.integers(1, 3, n), 'c': rng.integers(1, 5, n)})
    d['y'] = np.round(10 + 2 * d.a - 1.5 * (d.b == 2) * d.a + 0.3 * d.c ** 2 + rng.normal(0, 1, n), 2)
    d['w'] = rng.integers(1, 6, n)
    print('[unbalanced]')
    for c in 'abcyw':
        put(c, d[c].to_numpy())
    put('sources', ['a', 'b', 'c', 'a*b', 'residual'])
    formula = 'y ~ C(a, Sum) + C(b, Sum) + C(c, Sum) + C(a, Sum):C(b, Sum)'
    fit = smf.ols(formula, d).fit()
    for kind in (1, 2, 3):
        table = anova_lm(fit, typ=kind)
        table = table.drop(index='Intercept', errors='ignore')
        put(f'ss{kind}', table['sum_sq'].to_numpy())
        put(f'f{kind}', table['F'].to_numpy()[:-1])
        put(f'p{kind}', table['PR(>F)'].to_numpy()[:-1])
    weighted = smf.wls(formula, d, weights=d.w).fit()
    table = anova_lm(weighted, typ=3).drop(index='Intercept')
    put('weighted_ss3', table['sum_sq'].to_numpy())
    put('weighted_p3', table['PR(>F)'].to_numpy()[:-1])
    mse, total = fit.mse_resid, fit.centered_tss
    ss = anova_lm(fit, typ=3).drop(index='Intercept')
    effect = ss.iloc[:-1]
    put('omega2', ((effect['sum_sq'] - effect['df'] * mse) / (total + mse)).to_numpy())
    print()


def read(file):
    """A table without the units in its heads."""
    d = pd.read_csv(DATA / file, comment='#')
    return d.rename(columns=lambda head: head.split(' ')[0])


def second_order(f):
    pairs = [f'{a}*{b}' for i, a in enumerate(f) for b in f[i + 1:]]
    return ['const'] + f + [f'{a}^2' for a in f] + pairs


def column(d, term):
    if term == 'const':
        return np.ones(len(d))
    out = np.ones(len(d))
    for part in term.split('*'):
        name, _, power = part.partition('^')
        out = out * d[name].to_numpy() ** int(power or 1)
    return out


def surface(name, file, factors, response, coding, weights=None):
    d = read(file)
    terms = second_order(factors)
    x = np.array([column(d, t) for t in terms]).T
    coded = d.copy()
    for f in factors:
        low, high = coding[f]
        coded[f] = (d[f] - (low + high) / 2) / ((high - low) / 2)
    u = np.array([column(coded, t) for t in terms]).T
    y = d[response].to_numpy()
    w = np.ones(len(y)) if weights is None else weights
    # Natural columns are badly scaled for an explicit pseudo-inverse: QR, as statsmodels offers it.
    make = (lambda m: sm.OLS(y, m)) if weights is None else (lambda m: sm.WLS(y, m, weights=w))
    natural, fit = (make(m).fit(method='qr') for m in (x, u))
    influence = fit.get_influence() if weights is None else None
    print(f'[surface.{name}]')
    put('file', file)
    put('factors', factors)
    put('response', response)
    put('low', [coding[f][0] for f in factors])
    put('high', [coding[f][1] for f in factors])
    if weights is not None:
        put('weights', w)
    put('natural', natural.params)
    put('natural_error', natural.bse)
    put('natural_p', natural.pvalues)
    put('coded', fit.params)
    put('coded_error', fit.bse)
    put('r2', fit.rsquared)
    put('r2_adjusted', fit.rsquared_adj)
    put('s', np.sqrt(fit.mse_resid))
    put('f', fit.fvalue)
    put('p', fit.f_pvalue)
    if influence is not None:
        put('vif', [variance_inflation_factor(u, i) for i in range(1, len(terms))])
        put('natural_vif', [variance_inflation_factor(x, i) for i in range(1, len(terms))])
        put('leverage', influence.hat_matrix_diag)
        put('standardized', influence.resid_studentized_internal)
        put('studentized', influence.resid_studentized_external)
        put('cook', influence.cooks_distance[0])
        press = float((influence.resid_press ** 2).sum())
        put('press', press)
        put('r2_predicted', 1 - press / fit.centered_tss)
        groups = d.groupby(factors)[response]
        pure = float((groups.transform('mean') - d[response]).pow(2).sum())
        df_pure = len(d) - groups.ngroups
        df_lack = fit.df_resid - df_pure
        lack = (fit.ssr - pure) / df_lack / (pure / df_pure)
        put('pure_error', pure)
        put('lack_of_fit_f', lack)
        put('lack_of_fit_p', st.f.sf(lack, df_lack, df_pure))
    point = {f: coding[f][0] + 0.3 * (coding[f][1] - coding[f][0]) for f in factors}
    at = pd.DataFrame([{f: (point[f] - sum(coding[f]) / 2) / ((coding[f][1] - coding[f][0]) / 2) for f in factors}])
    row = np.array([column(at, t)[0] for t in terms])[None, :]
    said = fit.get_prediction(row).summary_frame(alpha=0.05).iloc[0]
    put('point', [point[f] for f in factors])
    put('prediction', said[['mean', 'mean_se', 'mean_ci_lower', 'mean_ci_upper', 'obs_ci_lower', 'obs_ci_upper']].to_numpy())
    k = len(factors)
    b = fit.params[1:1 + k]
    B = np.diag(fit.params[1 + k:1 + 2 * k])
    for t, value in zip(terms[1 + 2 * k:], fit.params[1 + 2 * k:]):
        i, j = (factors.index(f) for f in t.split('*'))
        B[i, j] = B[j, i] = value / 2
    stationary = np.linalg.solve(B, -b / 2)
    put('eigenvalues', np.linalg.eigvalsh(B)[::-1])
    put('stationary', stationary)
    put('stationary_value', fit.params[0] + b @ stationary / 2)
    # Ridge analysis: the best point on the sphere of radius 1, by direct search from the best of many starts.
    value = lambda v: fit.params[0] + b @ v + v @ B @ v
    for name, sign in (('highest', -1), ('lowest', 1)):
        rng = np.random.default_rng(1)
        runs = [scipy.optimize.minimize(lambda v: sign * value(v / np.linalg.norm(v)), rng.normal(size=k), tol=1e-14)
                for _ in range(20)]
        put(f'{name}_on_unit_sphere', sign * min(r.fun for r in runs))
    print()


def backward():
    d = read('table11.csv')
    terms = second_order(['Ec', 'kn_ks', 'mu', 'kn_ks_j'])
    powers = lambda t: {p.partition('^')[0]: int(p.partition('^')[2] or 1) for p in t.split('*')} if t != 'const' else {}
    contains = lambda a, b: all(powers(a).get(n, 0) >= k for n, k in powers(b).items())
    u = d.copy()
    for f in ['Ec', 'kn_ks', 'mu', 'kn_ks_j']:
        u[f] = (d[f] - (d[f].min() + d[f].max()) / 2) / ((d[f].max() - d[f].min()) / 2)
    gone = []
    while True:
        fit = sm.OLS(d['nu'], np.array([column(u, t) for t in terms]).T).fit(method='qr')
        p = dict(zip(terms, fit.pvalues))
        free = [t for t in terms if t != 'const' and not any(o != t and contains(o, t) for o in terms)]
        worst = max(free, key=p.get)
        if p[worst] <= 0.05:
            break
        gone.append((worst, p[worst]))
        terms.remove(worst)
    print('[backward]')
    put('gone', [t for t, _ in gone])
    put('p', [v for _, v in gone])
    put('kept', terms)
    put('r2', fit.rsquared)
    print()


def screening():
    y = np.array([45, 71, 48, 65, 68, 60, 80, 65, 43, 100, 45, 104, 75, 86, 70, 96], float)
    factors = 'ABCD'
    level = {f: np.array([1.0 if run >> k & 1 else -1.0 for run in range(16)]) for k, f in enumerate(factors)}
    terms = []
    for size in range(1, 5):
        terms += ['*'.join(c) for c in itertools.combinations(factors, size)]
    effect = np.array([2 * np.mean(np.prod([level[f] for f in t.split('*')], axis=0) * y) for t in terms])
    m = len(effect)
    s0 = 1.5 * np.median(abs(effect))
    pse = 1.5 * np.median(abs(effect)[abs(effect) < 2.5 * s0])
    print('[screening]')
    put('y', y)
    put('terms', terms)
    put('effects', effect)
    put('pse', pse)
    put('margin', pse * st.t.ppf(0.975, m / 3))
    put('simultaneous', pse * st.t.ppf((1 + 0.95 ** (1 / m)) / 2, m / 3))
    put('half_normal', st.norm.ppf(0.5 + 0.5 * (st.rankdata(abs(effect)) - 0.5) / m))
    put('normal', st.norm.ppf((st.rankdata(effect) - 0.5) / m))
    print()


print(f'# Generated by other_code.py: statsmodels {statsmodels.__version__}, scipy {scipy.__version__}, '
      f'numpy {np.__version__}, pandas {pd.__version__}, Python {sys.version.split()[0]}.')
print('tier = "other code"\n')
unbalanced()
unit = {'Ec': (10, 30), 'kn_ks': (1, 4), 'mu': (0.5, 1.5), 'Ecj': (5, 15), 'kn_ks_j': (1, 4),
        'sigma_c': (10, 30), 'tau_c': (10, 30)}
surface('ccd', 'table09.csv', ['sigma_c', 'tau_c'], 'UCS', unit)
surface('bbd_e', 'table10.csv', ['Ec', 'kn_ks', 'mu', 'Ecj', 'kn_ks_j'], 'E', unit)
surface('bbd_nu', 'table11.csv', ['Ec', 'kn_ks', 'mu', 'kn_ks_j'], 'nu', unit)
surface('weighted', 'table11.csv', ['Ec', 'kn_ks', 'mu', 'kn_ks_j'], 'nu', unit, 1.0 + np.arange(27) % 4)
backward()
screening()
