"""Time as utility: gain β T(p), loss α T(a) (specification, section 1.3; errata in section 1.6).

Times are in seconds and weights positive, so utilities are in weighted seconds.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np

_Time = TypeVar("_Time", bound=Any)


class Interaction(NamedTuple):
    """Times of one robot in an interaction, T(a) and T(p) (s), and their weights α and β."""

    t_a: float
    t_p: float
    alpha: float = 1.0
    beta: float = 1.0


def _mean(values: Sequence[float]) -> float:
    # Each mean is multiplied by its number of values, so the mean of none may be any finite number.
    return sum(values) / len(values) if values else 0.0


def share_of_time(part: _Time, t_a: _Time, t_p: _Time) -> _Time:
    """Return part / (T(a) + T(p)), elementwise for arrays and tables; 0 where no time has passed."""
    total = t_a + t_p
    share: _Time = part / np.where(total > 0, total, 1)
    return share


def time_utility(t_a: float, t_p: float, alpha: float, beta: float) -> float:
    """Return u = β_i T(p_i) − α_i T(a_i), for meeting one robot of the own swarm (Eq. 4.1)."""
    return beta * t_p - alpha * t_a


def intra_utility(n_k: float, t_a: float, t_p: float, alpha: float, beta: float) -> float:
    """Return u = n_k (β_i T(p_i) − α_i T(a_i)), for meeting `n_k` robots of the own swarm (Eq. 4.2)."""
    return n_k * time_utility(t_a, t_p, alpha, beta)


def pair_utility(own: Interaction, other: Interaction) -> float:
    """Return u = (β_i T(p_i) − α_i T(a_i)) − (β_j T(p_j) − α_j T(a_j)), for one opponent (Eq. 4.3).

    The opponent's utility is −u (Lemma 17).
    """
    return time_utility(*own) - time_utility(*other)


def inter_utility(own: Interaction, opponents: Sequence[Interaction]) -> float:
    """Return u = n_m (β_i T(p_i) − mean[βT(p)]) − n_m (α_i T(a_i) − mean[αT(a)]) (Eqs. 4.5, 4.6).

    The sum over all robots of two swarms that meet each other is zero (Lemma 19). `opponents` are the n_m
    robots of one other swarm that robot i met.
    """
    n_m = len(opponents)
    program = own.beta * own.t_p - _mean([j.beta * j.t_p for j in opponents])
    action = own.alpha * own.t_a - _mean([j.alpha * j.t_a for j in opponents])
    return n_m * program - n_m * action


def mixed_utility(own: Interaction, n_k: int, *opponents: Sequence[Interaction]) -> float:
    """Return U_i = u_i^k + Σ_{m≠k} u_i^m, for meeting several swarms at once (Eq. 4.7, Props. 20, 21).

    Robot i met `n_k` robots of its own swarm and `opponents` of each other swarm: one sequence in Prop. 20,
    several in Prop. 21.
    """
    return intra_utility(n_k, *own) + sum(inter_utility(own, swarm) for swarm in opponents)


def absence_utility_of_one(other: Interaction) -> float:
    """Return ε̃_j = β_j (T(p_j) + T(a_j)): without robot i, all of j's time is program time (Eq. 4.9)."""
    return other.beta * (other.t_p + other.t_a)


def absence_utility_of_swarm(others: Sequence[Interaction]) -> float:
    """Return ε̃_S = n mean[βT(p)] + n mean[βT(a)] over the robots that robot i met (Eqs. 4.10, 4.11).

    `others` are those of its own swarm in Eq. 4.10 and the opponents in Eq. 4.11.
    """
    n = len(others)
    return n * _mean([j.beta * j.t_p for j in others]) + n * _mean([j.beta * j.t_a for j in others])


def presence_utility_of_own_swarm(mates: Sequence[Interaction]) -> float:
    """Return ε_k = n_k (mean[βT(p)] − mean[αT(a)]), the own swarm's utility from robot i (Eqs. 4.12, 4.13).

    `mates` are the robots of its own swarm that it met.
    """
    return len(mates) * (_mean([j.beta * j.t_p for j in mates]) - _mean([j.alpha * j.t_a for j in mates]))


def approximate_wlu(
    own: Interaction, mates: Sequence[Interaction], opponents: Sequence[Interaction]
) -> float:
    """Return W_i from times measured in the presence of i, with a corrected sign (Eq. 4.14).

    W_i = (n_k + 2 n_m) β_i T(p_i) − (n_k + 2 n_m) α_i T(a_i) − n_k (mean_k[αT(a)] + mean_k[βT(a)])
    + n_m (2 mean_m[αT(a)] + mean_m[βT(a)] − mean_m[βT(p)]). The source has a minus
    before the last term; inserting Eqs. 4.2, 4.5 and 4.10 to 4.13 into Thm 13 gives a plus. `mates` and
    `opponents` are the n_k and n_m robots that robot i met of its own swarm and of all others.
    """
    n_k, n_m = len(mates), len(opponents)
    weight = n_k + 2 * n_m
    on_mates = _mean([j.alpha * j.t_a for j in mates]) + _mean([j.beta * j.t_a for j in mates])
    on_opponents = (
        2 * _mean([j.alpha * j.t_a for j in opponents])
        + _mean([j.beta * j.t_a for j in opponents])
        - _mean([j.beta * j.t_p for j in opponents])
    )
    return weight * own.beta * own.t_p - weight * own.alpha * own.t_a - n_k * on_mates + n_m * on_opponents


class Crowd(NamedTuple):
    """Numbers of robots of its own swarm k and of other swarms m that robot i met, and (mean) weights."""

    n_k: int
    n_m: int
    alpha_i: float = 1.0
    beta_i: float = 1.0
    alpha_k: float = 1.0
    beta_k: float = 1.0
    alpha_m: float = 1.0
    beta_m: float = 1.0


def gamma(crowd: Crowd) -> float:
    """Return Γ = (n_k + 2 n_m) β_i − n_m β̄_m, the weight of T(p) (Eqs. 5.1, 5.3)."""
    return (crowd.n_k + 2 * crowd.n_m) * crowd.beta_i - crowd.n_m * crowd.beta_m


def delta(crowd: Crowd) -> float:
    """Return Δ = n_m β̄_m − n_k β̄_k + 2 n_m ᾱ_m − n_k ᾱ_k − (n_k + 2 n_m) α_i (Eqs. 5.1, 5.3)."""
    by_program = crowd.n_m * crowd.beta_m - crowd.n_k * crowd.beta_k
    by_action = 2 * crowd.n_m * crowd.alpha_m - crowd.n_k * crowd.alpha_k
    return by_program + by_action - (crowd.n_k + 2 * crowd.n_m) * crowd.alpha_i


def wlu_of_equal_times(crowd: Crowd, t_a: float, t_p: float) -> float:
    """Return W_i = Γ T(p) + Δ T(a), Eq. 4.14 for equal times of all robots (Eq. 5.1)."""
    return gamma(crowd) * t_p + delta(crowd) * t_a


def wlu_per_robot_met(crowd: Crowd, t_a: float, t_p: float) -> float:
    """Return W_i / n = Γ/n · T(p) + Δ/n · T(a), n = n_k + n_m (Eqs. 5.2, 5.3)."""
    n = crowd.n_k + crowd.n_m
    return gamma(crowd) / n * t_p + delta(crowd) / n * t_a
