"""Wonderful Life Utility: what a player is worth to its swarm (specification, section 1.2).

Player ρ is of swarm k and meets swarm m. What others get *from* ρ is written ε, what they get in its
absence instead ε̃. Several opposing swarms count as one: what they have from each other cancels in the
difference by Eq. 3.1, so sums over them take the place of m.
"""

from kswarms.agents.theory.swarms import opponents_utility


def wonderful_life_utility(sud: float, sud_without: float) -> float:
    """Return W_ρ = SUD_k − SUD_k without ρ, its definition (Eq. 3.9).

    Parameters
    ----------
    sud, sud_without : float
        SUD of the swarm of ρ in the game with it, and in the same game without it.
    """
    return sud - sud_without


def effect_on_own_swarm(present: float, absent: float) -> float:
    """Return φ_k^ρ = ε_k^ρ − ε̃_k^ρ (Eq. 3.10).

    Parameters
    ----------
    present : float
        ε_k^ρ: what the others of its swarm get from ρ.
    absent : float
        ε̃_k^ρ: what they get in its absence instead.
    """
    return present - absent


def effect_on_opponents(u_inter: float) -> float:
    """Return ε_m^ρ = −u_ρ^m, what the opponents get from ρ (Lemma 10)."""
    return opponents_utility(u_inter)


def sud_by_parts(own_intra: float, others_intra: float, own_inter: float) -> float:
    """Return SUD_k = Σ u_i^k − Σ u_j^m + 2 Σ u_i^m, i ∈ k and j ∈ m (Eq. 3.11, Cor. 11).

    It is the difference of Eq. 3.7 with Eq. 3.2 put in.

    Parameters
    ----------
    own_intra, others_intra : float
        Σ_{i∈k} u_i^k and Σ_{j∈m} u_j^m: what either swarm has from itself.
    own_inter : float
        Σ_{i∈k} u_i^m: what swarm k has from swarm m.
    """
    return own_intra - others_intra + 2 * own_inter


def sud_without(own_intra: float, others_intra: float, own_inter: float, phi: float, absent: float) -> float:
    """Return SUD_k without ρ = Σ u_i^k − Σ u_j^m + 2 Σ u_i^m − φ_k^ρ − ε̃_m^ρ, i ≠ ρ (Cor. 12).

    The utilities are those of the game with ρ; what its absence changes in them is in φ and ε̃.

    Parameters
    ----------
    own_intra, own_inter : float
        Σ u_i^k and Σ u_i^m over the players of swarm k without ρ.
    others_intra : float
        Σ_{j∈m} u_j^m.
    phi : float
        φ_k^ρ.
    absent : float
        ε̃_m^ρ: what the opponents get in the absence of ρ instead of ε_m^ρ.
    """
    return sud_by_parts(own_intra, others_intra, own_inter) - phi - absent


def wlu_by_parts(u_intra: float, u_inter: float, phi: float, absent: float) -> float:
    """Return W_ρ = u_ρ^k + 2 u_ρ^m + φ_k^ρ + ε̃_m^ρ (Thm 13, Eq. 4.8).

    Parameters
    ----------
    u_intra, u_inter : float
        u_ρ^k and u_ρ^m.
    phi : float
        φ_k^ρ.
    absent : float
        ε̃_m^ρ: what the opponents get in the absence of ρ instead of ε_m^ρ.
    """
    return u_intra + 2 * u_inter + phi + absent
