"""What a robot can compute of its WLU from its own sensors (specification, section 1.4).

The weight of program time has been divided by β_i, so that results are in seconds.
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
        What stands for Γ/n': 1 for identical swarms (Eq. 6.2), else by Eq. 7.1 or 7.2.
    t_a, t_p : float
        T(a) and T(p) (s).
    n_active : int
        n'_i: sensors that were active.
    sign : {-1, 1}
        σ of Eq. 5.5.
    delta : float
        Δ.
    """
    return program * t_p + n_active / SENSORS * sign * abs(delta) * t_a


def identical_swarms_wlu(n_k: int, n_m: int, t_a: float, t_p: float, alpha: float, beta: float) -> float:
    """Return T(p) + ((n_m − n_k) β − 2 n_k α)/(nβ) · T(a), equal weights and times for all (Eq. 6.1).

    It is Eq. 5.2 divided by β. Eq. 6.2 estimates its second term.
    """
    return t_p + ((n_m - n_k) * beta - 2 * n_k * alpha) / ((n_k + n_m) * beta) * t_a


def program_weight(n_k: int, n_m: int, b: float) -> float:
    """Return (n_k + (2 − b) n_m)/n, by which T(p) counts where β_m = b β_i (Eq. 7.1)."""
    return (n_k + (2 - b) * n_m) / (n_k + n_m)


def program_weight_of_equals(b: float) -> float:
    """Return (3 − b)/2, the value of Eq. 7.1 for n_k = n_m, whom a robot cannot count (Eq. 7.2)."""
    return 0.5 * (3.0 - b)


def kappa(alpha_i: float, alpha_k: float, beta: float) -> float:
    """Return κ = (α_i + ᾱ_k + β)/β, by which T(a) counts in a swarm that is alone (section 6.3.5)."""
    return (alpha_i + alpha_k + beta) / beta
