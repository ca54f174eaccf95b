"""Estimates of the WLU from a robot's own sensors (specification, section 1.4).

All weights are divided by β_i, so results are in seconds.
"""

from kswarms.agents.body import SENSORS


def sigma(inter: bool, direction: int) -> int:
    """Return σ = f·d: f = +1 between swarms and −1 within, d = +1 towards and −1 away (Eq. 5.5)."""
    return direction if inter else -direction


def estimated_wlu(program: float, t_a: float, t_p: float, n_active: int, sign: int, delta: float) -> float:
    """Return R = (Γ/n') T(p) + (n'_i/n') · σ · |Δ| · T(a), n' = 8 (Eq. 5.4).

    Parameters
    ----------
    program : float
        Γ/n': 1 for identical swarms (Eq. 6.2), else by Eq. 7.1 or 7.2.
    t_a, t_p : float
        T(a) and T(p) (s).
    n_active : int
        n'_i, number of active sensors.
    sign : {-1, 1}
        σ of Eq. 5.5.
    delta : float
        Δ.
    """
    return program * t_p + n_active / SENSORS * sign * abs(delta) * t_a


def identical_swarms_wlu(n_k: int, n_m: int, t_a: float, t_p: float, alpha: float, beta: float) -> float:
    """Return T(p) + ((n_m − n_k) β − 2 n_k α)/(nβ) · T(a), for equal weights and times of all (Eq. 6.1).

    This is Eq. 5.2 divided by β. Eq. 6.2 estimates its second term.
    """
    return t_p + ((n_m - n_k) * beta - 2 * n_k * alpha) / ((n_k + n_m) * beta) * t_a


def program_weight(n_k: int, n_m: int, b: float) -> float:
    """Return (n_k + (2 − b) n_m)/n, the weight of T(p) for β_m = b β_i (Eq. 7.1)."""
    return (n_k + (2 - b) * n_m) / (n_k + n_m)


def program_weight_of_equals(b: float) -> float:
    """Return (3 − b)/2, Eq. 7.1 for n_k = n_m, since a robot cannot count them (Eq. 7.2)."""
    return 0.5 * (3.0 - b)


def kappa(alpha_i: float, alpha_k: float, beta: float) -> float:
    """Return κ = (α_i + ᾱ_k + β)/β, the weight of T(a) in a game of one swarm (section 6.3.5)."""
    return (alpha_i + alpha_k + beta) / beta
