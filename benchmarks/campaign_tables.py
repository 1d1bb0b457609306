"""Tables of the naming campaign, each share beside its goal and its binomial interval."""

from collections.abc import Callable, Iterable
from typing import Any, Final

import numpy as np
from scipy.stats import beta

from benchmarks.told_test import LENGTH, told_power

Row = dict[str, Any]

JUDGEMENTS: Final = {
    "right": "right",
    "right, and more": "and more",
    "in the set": "in the set",
    "one of two": "one of 2",
    "wrong": "wrong",
    "partly_explained": "partly",
    "unexplained": "unexpl.",
    "no_discrepancy": "none",
    "error": "error",
}
_FIRST: Final = ("right", "right, and more")
_PLAIN: Final = 1.5  # times what the test that is told the form finds


def share(hits: int, n: int) -> tuple[float, float, float]:
    """Return a share and its 95 % interval by Clopper and Pearson (1934).

    Parameters
    ----------
    hits, n
        How many of how many.
    """
    low = float(beta.ppf(0.025, hits, n - hits + 1)) if hits else 0.0
    high = float(beta.ppf(0.975, hits + 1, n - hits)) if hits < n else 1.0
    return hits / max(n, 1), low, high


def report(rows: list[Row]) -> None:
    """Print the campaign's tables and figures.

    Parameters
    ----------
    rows
        The record.
    """
    wired = sum(row["wire"] for row in rows)
    print(f"{len(rows)} draws, {wired} of them through the serial port and the DAQ client\n")
    _goals(rows)
    single = _of(rows, "single")
    strong = [row for row in single if row["strength"] >= 1.0]
    _table("size over noise", single, lambda row: _bin(row["strength"]))
    _table("cause (size 1 and more)", strong, lambda row: str(row["hidden"]["causes"][0]))
    _table("cause (size below 1)", _below(single), lambda row: str(row["hidden"]["causes"][0]))
    _table("noise correlation", strong, lambda row: f"{1e3 * row['correlation_s']:.0f} ms")
    _table("wander", strong, lambda row: f"{100 * row['wander']:.1f} %")
    _table("length", strong, lambda row: f"{row['duration_s']:.0f} s")
    _table("plan", strong, lambda row: str(row["plan"]))
    _table("drive frequencies", strong, lambda row: str(row["n_frequencies"]))
    _table("path", strong, lambda row: "pty and gRPC" if row["wire"] else "in process")
    _table("nothing hidden, wander", _of(rows, "nothing"), lambda r: f"{100 * r['wander']:.1f} %")
    _table("outside the library", _of(rows, "outside"), _mechanism)
    _table("two causes, the smaller", _of(rows, "two"), lambda row: _bin(row["weakest"]))


def wrong_ones(rows: list[Row]) -> None:
    """Print a line for each draw that did not come out as it ought to.

    Parameters
    ----------
    rows
        The record.
    """
    print("\nnot as they ought to be:")
    for row in rows:
        if _as_it_ought(row):
            continue
        hidden = row["hidden"]
        said = "+".join(row["named"]) or row["verdict"]
        if row["alternatives"]:
            said += f" (or {', '.join(row['alternatives'])})"
        print(
            f"{hidden['group']:8} {'+'.join(hidden['defects']) or '-':40} {row['strength']:6.2f}x "
            f"-> {said}; {row['plan']} {row['duration_s']:.0f} s at {row['n_frequencies']}, "
            f"{1e3 * row['correlation_s']:.0f} ms, {100 * row['wander']:.1f} %, "
            f"motor {row['motor']} draw {row['number']} {row['error']}"
        )


def _as_it_ought(row: Row) -> bool:
    group = row["hidden"]["group"]
    if group == "nothing":
        return bool(row["verdict"] == "no_discrepancy")
    if group == "outside":
        return not row["named"] and not row["error"]
    return bool(row["judgement"] == "right")


def _of(rows: Iterable[Row], group: str) -> list[Row]:
    return [row for row in rows if row["hidden"]["group"] == group]


def _below(single: Iterable[Row]) -> list[Row]:
    return [row for row in single if row["strength"] < 1.0]


def _mechanism(row: Row) -> str:
    return str(row["hidden"]["defects"][0].partition("=")[0])


def _goals(rows: list[Row]) -> None:
    """Print each share that is asked for beside its goal."""
    single, nothing, two = _of(rows, "single"), _of(rows, "nothing"), _of(rows, "two")
    strong = [row for row in single if row["strength"] >= 1.0]
    weak = [row for row in single if 0.2 <= row["strength"] < 0.5]
    outside = [row for row in _of(rows, "outside") if row["strength"] >= 1.0]
    both = [row for row in two if row["weakest"] >= 1.0]
    print(f"{'':52} share   95 % interval     n   goal")
    _goal("right first, size 1 x noise and more", strong, _right, ">= 98 %")
    _goal("in the set, size 1 x noise and more", strong, _in_set, ">= 99.5 %")
    _goal("right first, size 0.2 to 0.5 x noise", weak, _right, ">= 90 %")
    told = [row for row in single if row.get("told") is not None]  # not by chance, nor of old
    plain = [row for row in told if row["told"] >= _PLAIN * LENGTH]
    _goal(f"right first, small, {_PLAIN} x what a told test finds", plain, _right, ">= 90 %")
    loud = [row for row in single if row["rms"] >= 1.0]
    _goal("right first, by plain rms, a handful of windows too", loud, _right, "")
    _goal("wrong name first, all sizes", single, lambda r: r["judgement"] == "wrong", "")
    _goal("false alarms, nothing hidden", nothing, _alarm, "<= 5 %")
    for wander in sorted({row["wander"] for row in nothing}):
        some = [row for row in nothing if row["wander"] == wander]
        _goal(f"false alarms, wander {100 * wander:.1f} %", some, _alarm, "<= 5 %")
    for n in sorted({row["n_frequencies"] for row in nothing}):
        some = [row for row in nothing if row["n_frequencies"] == n]
        _goal(f"false alarms, drive frequencies: {n}", some, _alarm, "<= 5 %")
    _goal("outside the library kept unnamed, size 1 and more", outside, _unnamed, ">= 90 %")
    _goal(
        "both of two named, each of size 1 and more",
        both,
        lambda r: r["judgement"] == "right",
        ">= 85 %",
    )
    _goal("both of two named or alternatives", both, _in_set, "")
    _intervals(single)
    named = [r for r in strong if r["gain"] is not None and _right(r)]
    again = [row for row in named if row["fresh_gain"] is not None]
    _goal("gain on a fresh run at least 0.9 of the oracle's", again, _near_oracle, "")
    _goal("claimed gain within 0.05 of a fresh run's", again, _near_fresh, "")
    _gains(again)
    _told_finds([row["told"] for row in weak if row.get("told") is not None])


def _goal(label: str, rows: list[Row], hit: Callable[[Row], bool], goal: str) -> None:
    n, hits = len(rows), sum(bool(hit(row)) for row in rows)
    mean, low, high = share(hits, n)
    shown = f"{100 * mean:5.1f} %  {100 * low:5.1f} to {100 * high:5.1f} %" if n else f"{'-':>24}"
    print(f"{label:50} {shown} {n:5}   {goal}")


def _right(row: Row) -> bool:
    return row["judgement"] in _FIRST


def _in_set(row: Row) -> bool:
    return row["judgement"] in (*_FIRST, "in the set")


def _alarm(row: Row) -> bool:
    return bool(row["verdict"] != "no_discrepancy")


def _unnamed(row: Row) -> bool:
    return not row["named"] and not row["error"]


def _near_oracle(row: Row) -> bool:
    return bool(row["fresh_gain"] >= 0.9 * row["oracle_gain"])


def _near_fresh(row: Row) -> bool:
    return bool(abs(row["gain"] - row["fresh_gain"]) <= 0.05)


def _intervals(rows: list[Row]) -> None:
    found = [
        {"in": low <= truth <= high}
        for row in rows
        for truth, low, _, high in row["intervals"].values()
    ]
    _goal("95 % interval holds the true parameter", found, lambda r: r["in"], "95 +- 3 %")


def _gains(again: list[Row]) -> None:
    """Print the gain on a fresh run beside the oracle's, and the claimed one beside it."""
    if not again:
        return
    ratio = [row["fresh_gain"] / max(row["oracle_gain"], 1e-3) for row in again]
    print(f"\ngain on a fresh run over the oracle's: median {np.median(ratio):.3f} (goal 0.9)")
    off = np.array([row["gain"] - row["fresh_gain"] for row in again])
    print(
        f"claimed less fresh gain: median {np.median(off):+.3f}, median size "
        f"{np.median(np.abs(off)):.3f} (goal 0.05)"
    )


def _told_finds(lengths: list[float]) -> None:
    """Print how many effects the test would find that is told their form."""
    if lengths:
        power = 100.0 * float(np.mean([told_power(length) for length in lengths]))
        print(f"\na test told the form finds {power:.1f} % of {len(lengths)} of 0.2 to 0.5 x")


def _table(title: str, rows: Iterable[Row], key: Callable[[Row], str]) -> None:
    """Print how often each judgement came, a line for each value of the key."""
    groups: dict[str, list[str]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row["judgement"])
    if not groups:
        return
    print(f"\n{title:24}     n " + " ".join(f"{label:>10}" for label in JUDGEMENTS.values()))
    for name in sorted(groups):
        found = groups[name]
        shares = " ".join(f"{100 * found.count(j) / len(found):8.1f} %" for j in JUDGEMENTS)
        print(f"{name:24} {len(found):5} {shares}")


def _bin(strength: float) -> str:
    for low, high in ((0.0, 0.2), (0.2, 0.5), (0.5, 1.0), (1.0, 3.0), (3.0, 10.0)):
        if strength < high:
            return f"{low:4.1f} to {high:4.1f} x"
    return "10.0 x and more"
