#!/usr/bin/env bash
# The covariance of a fit by odrpack, beside its standard errors.
#
# Expected: sd_beta are the roots of the diagonal of cov_beta, which the documentation calls "Covariance matrix of
# the estimated parameters".
# What happens: sd_beta has the variance of the residuals in it and cov_beta has not: it is to be multiplied by
# res_var, which the documentation of neither says. Without weights, as in most first fits, errors from
# cov_beta are 100 times too large where the noise is 0.01, as in millimetres, and 20 times too small where it is
# 20, as in micrometres; sd_beta is right in both. With weights of the true noise all agree.
# Whom it hurts: whoever takes errors of sums, distances or predictions from the matrix, for which it is there, and
# those of single parameters from the vector: the first are off by any factor.
# poecal: the covariance of its results has the noise in it that was found: ten times the noise makes it a hundred
# times as large.
set -euo pipefail
here=$(mktemp -d); trap 'rm -rf "$here"' EXIT
python3 -m venv "$here/venv"
"$here/venv/bin/pip" install -q --disable-pip-version-check odrpack==0.7.0 numpy==2.4.6
"$here/venv/bin/python" - <<'PY'
import sys
from importlib.metadata import version
import numpy as np
from odrpack import OdrResult, odr_fit

print("odrpack", version("odrpack"))
(line,) = (i for i, line in enumerate(OdrResult.__doc__.splitlines()) if line.strip().startswith("cov_beta"))
print("documentation:", " ".join(" ".join(OdrResult.__doc__.splitlines()[line : line + 2]).split()))
random = np.random.default_rng(1)
X = np.linspace(0, 1, 40)
unchanged = "Covariance matrix of the estimated parameters" in OdrResult.__doc__


def line_of(x, beta):
    return beta[0] + beta[1] * x


print("error of the slope:           true    sd_beta   by cov_beta   by cov_beta and res_var")
for name, noise, weight in (("0.01 mm, no weights", 0.01, None), ("20 um, no weights", 20.0, None), ("0.01 mm, weights of it", 0.01, 1e4)):
    slopes, errors, plain, scaled = [], [], [], []
    for _ in range(300):
        y = 2 + 3 * X + noise * random.normal(size=len(X))
        found = odr_fit(line_of, X, y, np.array([1.0, 1.0]), task="OLS", weight_y=weight)
        slopes.append(found.beta[1])
        errors.append(found.sd_beta[1])
        plain.append(np.sqrt(found.cov_beta[1, 1]))
        scaled.append(np.sqrt(found.cov_beta[1, 1] * found.res_var))
    true, stated, matrix, both = np.std(slopes), *(np.mean(each) for each in (errors, plain, scaled))
    print(f"  {name:24} {true:9.5f} {stated:9.5f} {matrix:10.5f} {both:14.5f}")
    unchanged = unchanged and abs(stated / true - 1) < 0.15 and np.allclose(errors, scaled, rtol=1e-6)
    unchanged = unchanged and (abs(matrix / true - 1) < 0.15 if weight else abs(matrix * noise / true - 1) < 0.15)
print("as described" if unchanged else "CHANGED: the behaviour is not what this file describes")
sys.exit(not unchanged)
PY
