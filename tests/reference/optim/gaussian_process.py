"""Reference for src/optim/surrogate/gaussian.rs: scikit-learn's Gaussian process with the same covariance.

k(z, z') = c^2 + a^2 z.z' + q^2 (z.z')^2 + s^2 exp(-|z - z'|^2 / 2 l^2) + sigma^2 delta, sizes held fixed.
Writes gaussian_process.toml beside itself; run with numpy 2.4.6, scikit-learn 1.9.1.
"""
import pathlib
import numpy as np
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, DotProduct, WhiteKernel

SIZES = dict(constant=3.0, linear=0.4, quadratic=0.1, smooth=0.07, length=0.9, noise=0.03)


def kernel(constant, linear, quadratic, smooth, length, noise):
    k = ConstantKernel(constant**2) + ConstantKernel(linear**2)*DotProduct(0.0)
    k += ConstantKernel(quadratic**2)*DotProduct(0.0)**2
    if smooth:
        k += ConstantKernel(smooth**2)*RBF(length)
    return k + WhiteKernel(noise**2)


def numbers(values):
    return "[" + ", ".join(repr(float(v)) for v in values) + "]"


rng = np.random.default_rng(6)
z = np.round(rng.uniform(-1, 1, (12, 3)), 3)
y = np.round(.3*z[:, 0] - .2*z[:, 1] + .1*z[:, 0]*z[:, 2] + .05*np.sin(4*z[:, 1]) + .03*rng.standard_normal(12), 4)
at = np.round(rng.uniform(-1.2, 1.2, (5, 3)), 3)
lines = ["# Made by gaussian_process.py with scikit-learn 1.9.1; tier: other code."]
lines += ["points = [" + ", ".join(numbers(p) for p in z) + "]", "values = " + numbers(y)]
lines += ["at = [" + ", ".join(numbers(p) for p in at) + "]"]
for name, sizes in {"full": SIZES, "quadratic": dict(SIZES, smooth=0.0)}.items():
    gp = GaussianProcessRegressor(kernel(**sizes), optimizer=None, alpha=0.0).fit(z, y)
    mean, deviation = gp.predict(at, return_std=True)
    # scikit-learn's deviation is that of a new run; ours that of the expected response.
    variance = deviation**2 - sizes["noise"]**2
    lines += ["", f"[{name}]"] + [f"{k} = {float(v)!r}" for k, v in sizes.items()]
    lines += ["mean = " + numbers(mean), "variance = " + numbers(variance)]
    lines += [f"likelihood = {float(gp.log_marginal_likelihood_value_)!r}"]
pathlib.Path(__file__).with_suffix(".toml").write_text("\n".join(lines) + "\n")
