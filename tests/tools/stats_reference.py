"""Writes tests/data/stats_reference.json: numbers of eval/stats and of the report page as SciPy and statsmodels give them.

Run once, with both in a virtual environment: python tests/tools/stats_reference.py
"""
import json
import pathlib

import numpy as np
import scipy
import scipy.stats
import statsmodels
from statsmodels.stats.multitest import multipletests

rng = np.random.default_rng(20240501)
wilson = []
for k, n in [(0, 1), (1, 1), (0, 10), (10, 10), (3, 7), (50, 100), (187, 200), (199, 200), (1, 5000), (4321, 5000)]:
    for confidence in (0.9, 0.95, 0.99):
        ci = scipy.stats.binomtest(k, n).proportion_ci(confidence, method="wilson")
        wilson.append({"k": k, "n": n, "confidence": confidence, "low": ci.low, "high": ci.high})

mcnemar = [
    {"a": a, "b": b, "p": scipy.stats.binomtest(a, a + b, 0.5).pvalue}
    for a, b in [(1, 0), (0, 5), (5, 5), (3, 12), (40, 61), (0, 30), (300, 260), (7, 8)]
]

# Bonett & Price 2012, as the paper has it: neither library does.
z = scipy.stats.norm.ppf(0.975)
paired_rates = []
for a, b, n in [(1, 7, 21), (0, 0, 10), (0, 30, 30), (12, 3, 100), (260, 300, 5000)]:
    p, q = (a + 1) / (n + 2), (b + 1) / (n + 2)
    half = z * ((p + q - (q - p) ** 2) / (n + 2)) ** 0.5
    low, high = max(-1.0, q - p - half), min(1.0, q - p + half)
    paired_rates.append({"only_a": a, "only_b": b, "n": n, "low": low, "high": high})

holm = []
for p in ([0.01], [0.01, 0.04, 0.03, 0.005], [0.5, 0.5, 0.6], [0.04, 0.04, 0.04, 0.9, 0.0001]):
    holm.append({"p": p, "adjusted": list(multipletests(p, method="holm")[1])})

bootstrap = []
for n, shift, scale in [(12, 0.0, 1.0), (60, 0.3, 2.0), (200, -1.5, 0.5)]:
    a = rng.gamma(2.0, 1.0, n)
    b = a + rng.normal(-shift, scale, n)
    result = scipy.stats.bootstrap(
        (a - b,), np.mean, n_resamples=200000, method="percentile", rng=np.random.default_rng(7), batch=5000
    )
    ci = result.confidence_interval
    bootstrap.append({"a": list(a), "b": list(b), "mean": float(np.mean(a - b)), "low": ci.low, "high": ci.high})

target = pathlib.Path(__file__).parents[1] / "data" / "stats_reference.json"
origin = f"tests/tools/stats_reference.py with scipy {scipy.__version__}, statsmodels {statsmodels.__version__}"
parts = {"wilson": wilson, "mcnemar": mcnemar, "paired_rates": paired_rates, "holm": holm, "bootstrap": bootstrap}
target.write_text(json.dumps({"origin": origin, **parts}) + "\n")
