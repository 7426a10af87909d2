#!/usr/bin/env bash
# Standard errors of a fit with a robust loss, in lmfit and SciPy.
#
# Expected: with loss="soft_l1" an outlier hardly changes the parameters, and as little their stated errors.
# What happens: the parameters hardly change. But lmfit multiplies the covariance by the reduced chi square
# (scale_covar, its default for a Model), and computes that of the plain residuals, as if no loss had been
# chosen: one row of 60 that is off by 200 sigma makes the stated errors 30 times too large. With
# scale_covar=False, and of curve_fit in SciPy with absolute_sigma, they are 1.3 times too large with
# and without outliers, since the loss flattens the cost by which they are computed.
# Whom it hurts: whoever fits with a loss because there are outliers, and then reads the errors: what was
# determined well is reported as not determined.
# poecal: states errors by the weights that the rows have in the fit; a row that is off by 50 mm leaves the
# expected error of the example robot within 10 % of what it was.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check lmfit==1.3.4 numpy==2.4.6 scipy==1.17.1
"$here/venv/bin/python" -W ignore - <<'PY'
import sys
from importlib.metadata import version
import lmfit
import numpy as np
import scipy
from scipy.optimize import curve_fit

print("lmfit", version("lmfit"), "and SciPy", scipy.__version__)
SIGMA, ROWS, SESSIONS = 0.1, 60, 200
at = np.linspace(0, 1, ROWS)


def line(x, offset, slope):
    return offset + slope * x


model = lmfit.Model(line)


def by_lmfit(values, **options):
    fit = model.fit(values, x=at, offset=1, slope=1, weights=np.full(ROWS, 1 / SIGMA), method="least_squares", **options)
    return np.array([[each.value, each.stderr] for each in fit.params.values()]).T


def by_scipy(values):
    found, covariance = curve_fit(line, at, values, (1, 1), np.full(ROWS, SIGMA), True, method="trf", loss="soft_l1")
    return found, np.sqrt(np.diag(covariance))


SOFT = {"loss": "soft_l1"}
WAYS = {
    "lmfit, plain": by_lmfit,
    "lmfit, soft_l1": lambda values: by_lmfit(values, fit_kws=SOFT),
    "lmfit, soft_l1, not scaled": lambda values: by_lmfit(values, fit_kws=SOFT, scale_covar=False),
    "SciPy, soft_l1": by_scipy,
}
unchanged = True
for outliers in (0, 1):
    random = np.random.default_rng(1)
    seen = {name: [] for name in WAYS}
    for _ in range(SESSIONS):
        values = line(at, 2, 3) + SIGMA * random.standard_normal(ROWS)
        values[random.integers(ROWS, size=outliers)] += 200 * SIGMA
        for name, way in WAYS.items():
            seen[name].append(way(values))
    print(f"{outliers} of {ROWS} rows off by 200 sigma: the offset, over {SESSIONS} sessions")
    for name, results in seen.items():
        found, stated = np.array(results)[:, :, 0].T
        scatter, stated = np.std(found), np.mean(stated)
        print(f"  {name:27} scatter {scatter:.4f}  stated error {stated:.4f}  ratio {stated / scatter:6.2f}")
        ratio = stated / scatter
        if name == "lmfit, plain":
            unchanged = unchanged and (0.85 < ratio < 1.15 or outliers)
        elif name == "lmfit, soft_l1" and outliers:
            unchanged = unchanged and ratio > 20
        else:
            unchanged = unchanged and 1.1 < ratio < 1.5
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
