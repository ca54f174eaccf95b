"""Wonderful Life Utility: the contribution of a player to its swarm (specification, section 1.2).

Player ρ belongs to swarm k and meets swarm m. ε is the utility of others from ρ, ε̃ their utility in its place
if ρ is absent. Several opposing swarms count as one swarm m, since their utilities from each other cancel in
the SUD (Eq. 3.1).
"""

from kswarms.agents.theory.swarms import opponents_utility


def wonderful_life_utility(sud: float, sud_without: float) -> float:
    """Return W_ρ = SUD_k − SUD_k without ρ, the definition (Eq. 3.9)."""
    return sud - sud_without


def effect_on_own_swarm(present: float, absent: float) -> float:
    """Return φ_k^ρ = ε_k^ρ − ε̃_k^ρ, the effect of ρ on the others of its swarm (Eq. 3.10)."""
    return present - absent


def effect_on_opponents(u_inter: float) -> float:
    """Return ε_m^ρ = −u_ρ^m, the utility of the opponents from ρ (Lemma 10)."""
    return opponents_utility(u_inter)


def sud_by_parts(own_intra: float, others_intra: float, own_inter: float) -> float:
    """Return SUD_k = Σ u_i^k − Σ u_j^m + 2 Σ u_i^m, i ∈ k and j ∈ m (Eq. 3.11, Cor. 11).

    This is Eq. 3.7 with Eq. 3.2 inserted; the arguments are the three sums.
    """
    return own_intra - others_intra + 2 * own_inter


def sud_without(own_intra: float, others_intra: float, own_inter: float, phi: float, absent: float) -> float:
    """Return SUD_k without ρ = Σ u_i^k − Σ u_j^m + 2 Σ u_i^m − φ_k^ρ − ε̃_m^ρ, i ≠ ρ (Cor. 12).

    Parameters
    ----------
    own_intra, others_intra, own_inter : float
        Σ u_i^k, Σ u_j^m and Σ u_i^m in the game with ρ; the sums over i exclude ρ.
    phi, absent : float
        φ_k^ρ and ε̃_m^ρ.
    """
    return sud_by_parts(own_intra, others_intra, own_inter) - phi - absent


def wlu_by_parts(u_intra: float, u_inter: float, phi: float, absent: float) -> float:
    """Return W_ρ = u_ρ^k + 2 u_ρ^m + φ_k^ρ + ε̃_m^ρ (Thm 13, Eq. 4.8); the arguments in this order."""
    return u_intra + 2 * u_inter + phi + absent
