"""Fits through the origin, by groups and with categories, standardised effects, box plots and histograms by other programs.

python3 models.py > models.toml
"""
import sys
import numpy as np
import pandas as pd
import scipy
import scipy.stats as st
import statsmodels
import statsmodels.api as sm
import statsmodels.formula.api as smf


def put(key, value):
    if isinstance(value, (list, tuple, np.ndarray, pd.Series)):
        value = list(value)
        text = ', '.join(f"'{v}'" if isinstance(v, str) else repr(float(v)) for v in value)
        print(f'{key} = [{text}]')
    else:
        print(f'{key} = {float(value)!r}' if not isinstance(value, str) else f"{key} = '{value}'")


def origin():
    """Strength over bond strength/(1 + ratio), by radius and ratio: the sweep of a Brazilian campaign, made up."""
    rng = np.random.default_rng(3)
    rows = [(r, k, s) for r in (0.1, 0.25) for k in (1.0, 2.0, 4.0) for s in (1.0, 5.0, 15.0, 20.0, 30.0)]
    d = pd.DataFrame(rows, columns=['radius', 'ratio', 'scn'])
    slope = 0.5 + 0.2 * d['ratio']
    d['st'] = (d['scn'] / (1 + d['ratio']) * slope * (1 + 0.05 * rng.normal(size=len(d)))).round(4)
    print('[origin]')
    for column in d:
        put(column, d[column])
    found = []
    for _, own in d.groupby(['radius', 'ratio']):
        x = own['scn'] / (1 + own['ratio'])
        zero = sm.OLS(own['st'], x).fit()
        line = sm.OLS(own['st'], sm.add_constant(x)).fit()
        mean = 1 - zero.ssr / ((own['st'] - own['st'].mean()) ** 2).sum()
        found.append([zero.params.iloc[0], zero.bse.iloc[0], zero.rsquared, mean, zero.pvalues.iloc[0],
                      line.params.iloc[0], line.params.iloc[1], line.bse.iloc[0], line.bse.iloc[1], line.rsquared])
    names = ['slope', 'slope_error', 'r2', 'r2_about_mean', 'slope_p',
             'intercept', 'with_slope', 'intercept_error', 'with_slope_error', 'with_r2']
    for name, values in zip(names, np.array(found).T):
        put(name, values)
    # the band of the line through the origin of the first group, at a strength of 12 and ratio 1
    own = d[(d.radius == 0.1) & (d.ratio == 1.0)]
    said = sm.OLS(own['st'], own['scn'] / 2).fit().get_prediction([[6.0]])
    put('band', [said.predicted_mean[0], *said.conf_int(alpha=0.05)[0], *said.conf_int(obs=True, alpha=0.05)[0]])
    cells = d.pivot_table(index='radius', columns='ratio', values='st', aggfunc=['mean', 'std'])
    put('pivot_mean', cells['mean'].to_numpy().ravel())
    put('pivot_std', cells['std'].to_numpy().ravel())
    print()


def categories():
    rng = np.random.default_rng(7)
    n = 26
    d = pd.DataFrame({
        'cement': rng.choice(['slag', 'CEM I*', 'fly ash'], n, p=[0.5, 0.2, 0.3]),
        'aggregate': rng.choice(['basalt', 'limestone'], n),
        'w': rng.uniform(0.3, 0.7, n).round(2),
    })
    d['y'] = (60 - 50 * d['w'] + d['cement'].map({'slag': 4, 'CEM I*': 0, 'fly ash': -6})
              + d['aggregate'].map({'basalt': 3, 'limestone': 0}) + rng.normal(size=n)).round(2)
    print('[categories]')
    for column in d:
        put(column, d[column])
    fit = smf.ols('y ~ C(cement) + w', d).fit()
    put('terms', ['const', 'cement[fly ash]', 'cement[slag]', 'w'])
    put('estimate', fit.params)
    put('error', fit.bse)
    put('p_values', fit.pvalues)
    put('r2', fit.rsquared)
    fit = smf.ols('y ~ C(cement) * w', d).fit()
    put('with_products', fit.params)
    put('with_products_error', fit.bse)
    fit = smf.ols('y ~ C(cement, Sum) + C(aggregate, Sum)', d).fit()
    table = sm.stats.anova_lm(fit, typ=3)
    put('ss3', table['sum_sq'].iloc[1:])
    put('f3', table['F'].iloc[1:3])
    put('p3', table['PR(>F)'].iloc[1:3])
    put('level_means', d.groupby('cement')['y'].mean())
    print()


def plackett_burman():
    """Twelve runs from the published generator + + - + + + - - - + - (Plackett and Burman 1946)."""
    first = [1, 1, -1, 1, 1, 1, -1, -1, -1, 1, -1]
    rows = np.array([np.roll(first, i) for i in range(11)] + [[-1] * 11])[:, :7]
    rng = np.random.default_rng(11)
    y = (8 + 5.1 * rows[:, 4] + 1.2 * rows[:, 0] + rng.normal(size=12)).round(3)
    names = list('ABCDEFG')
    fit = sm.OLS(y, sm.add_constant(rows)).fit()
    print('[plackett_burman]')
    for name, column in zip(names, rows.T):
        put(name, column)
    put('y', y)
    put('effects', 2 * fit.params[1:])
    put('standardized', fit.tvalues[1:])
    put('p_values', fit.pvalues[1:])
    put('critical', st.t.ppf(0.975, fit.df_resid))
    print()


def plain():
    rng = np.random.default_rng(5)
    print('[plain]')
    for name, values in (('normal', rng.normal(30, 3, 40)), ('skew', rng.lognormal(1, 1, 200)), ('few', rng.normal(size=5))):
        values = values.round(3)
        put(f'{name}', values)
        q = np.quantile(values, [0.25, 0.5, 0.75])
        reach = 1.5 * (q[2] - q[0])
        inside = values[(values >= q[0] - reach) & (values <= q[2] + reach)]
        put(f'{name}_box', [inside.min(), *q, inside.max(), values.mean(), values.std(ddof=1)])
        low, high = st.t.interval(0.95, len(values) - 1, values.mean(), st.sem(values))
        put(f'{name}_half', (high - low) / 2)
        counts, edges = np.histogram(values, bins='auto')
        put(f'{name}_counts', counts)
        put(f'{name}_edges', edges)


print(f'# Generated by models.py: statsmodels {statsmodels.__version__}, scipy {scipy.__version__}, '
      f'numpy {np.__version__}, pandas {pd.__version__}, Python {sys.version.split()[0]}.')
print('tier = "other code"\n')
origin()
categories()
plackett_burman()
plain()
