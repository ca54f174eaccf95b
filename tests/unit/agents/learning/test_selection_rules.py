"""Selection rules compared with values computed by hand and with their definitions over whole histories."""

import math
from collections import Counter
from itertools import pairwise, permutations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chisquare

from kswarms.agents.common.errors import InputError
from kswarms.agents.learning.bandit import Bandit
from kswarms.agents.learning.selection_rules import (
    GAMMA,
    RULES,
    UCB,
    DiscountedUCB,
    Greedy,
    PeriodicRandom,
    Rule,
    UniformRandom,
)
from kswarms.agents.streams import Purpose, stream

FIRST_UNTRIED = [UCB(), DiscountedUCB(), Greedy(), PeriodicRandom()]
SURE = 1e-4
"""Significance level of the statistical tests."""


class CountingGenerator:
    """A random generator that returns one value and counts the calls."""

    def __init__(self, value: float = 0.0) -> None:
        self.value = value
        self.calls = 0

    def random(self) -> float:
        self.calls += 1
        return self.value


def bandit(*arms: tuple[float, float], time: float = 10.0) -> Bandit:
    """Return a bandit with these Q and N of each arm."""
    known = Bandit(len(arms))
    known.reward = [q * time * n for q, n in arms]
    known.time = [time * n for _, n in arms]
    known.count = [n for _, n in arms]
    return known


def choose(rule: Rule, known: Bandit, rng: CountingGenerator | None = None) -> int:
    return rule.choose(known, rng or CountingGenerator())  # type: ignore[arg-type]


def tied_arms(rule: Rule, known: Bandit) -> set[int]:
    """Return the arms among which a rule chooses at random."""
    return {choose(rule, known, CountingGenerator(k / 100)) for k in range(100)}


def test_ucb_equals_values_computed_by_hand() -> None:
    # N = 3 + 1, ln 4 = 1.38629, γ ln N = 0.155 · 1.38629 = 0.214876.
    # Bonuses: sqrt(0.214876 / 3) = 0.267629, sqrt(0.214876 / 1) = 0.463547, difference 0.195918.
    rule = UCB(gamma=0.155)
    assert choose(rule, bandit((0.5, 3), (0.3040, 1))) == 0  # 0.767629 > 0.767547
    assert choose(rule, bandit((0.5, 3), (0.3042, 1))) == 1  # 0.767629 < 0.767747


def test_ucb_with_three_arms_equals_values_computed_by_hand() -> None:
    # N = 1 + 2 + 5 = 8, γ ln N = 1 · 2.079442. Bonuses 1.442027, 1.019667, 0.644894.
    assert choose(UCB(gamma=1), bandit((0.0, 1), (0.42, 2), (0.797, 5))) == 0  # 1.4420 1.4397 1.4419
    assert choose(UCB(gamma=1), bandit((0.0, 1), (0.43, 2), (0.797, 5))) == 1  # 1.4420 1.4497 1.4419
    assert choose(UCB(gamma=1), bandit((0.0, 1), (0.42, 2), (0.798, 5))) == 2  # 1.4420 1.4397 1.4429


ARMS = st.lists(st.tuples(st.floats(-1, 1), st.integers(1, 500)), min_size=2, max_size=6)


@given(ARMS, st.floats(0, 2))
def test_ucb_chooses_the_greatest_bound(arms: list[tuple[float, int]], gamma: float) -> None:
    n = sum(count for _, count in arms)
    bounds = [q + math.sqrt(gamma * math.log(n) / count) for q, count in arms]
    arm = choose(UCB(gamma=gamma), bandit(*arms))
    assert bounds[arm] >= max(bounds) - 1e-9


@given(ARMS)
def test_greedy_and_ucb_without_exploration_choose_the_greatest_value(arms: list[tuple[float, int]]) -> None:
    known = bandit(*arms)
    for rule in (Greedy(), UCB(gamma=0)):
        assert known.value(choose(rule, known)) == max(known.value(arm) for arm in range(len(arms)))


def test_only_ties_are_broken_by_a_draw() -> None:
    rng = CountingGenerator()
    for rule in (UCB(), DiscountedUCB(), Greedy(), PeriodicRandom()):
        assert tied_arms(rule, bandit((0.5, 4), (0.25, 4), (0.5, 4))) == {0, 2}
        choose(rule, bandit((0.5, 4), (0.25, 4)), rng)
    assert rng.calls == 0


@pytest.mark.parametrize("rule", FIRST_UNTRIED, ids=repr)
def test_untried_arms_come_first(rule: Rule) -> None:
    known = bandit((1.0, 1000), (0.0, 0), (-1.0, 1000), (0.0, 0))
    assert tied_arms(rule, known) == {1, 3}
    known.update(3, -5.0, 1.0)
    assert tied_arms(rule, known) == {1}
    known.choices = 4  # the next choice of periodic-random would be random
    assert tied_arms(rule, known) == {1}


@pytest.mark.parametrize("rule", FIRST_UNTRIED, ids=repr)
def test_the_order_of_untried_arms_is_random(rule: Rule) -> None:
    orders: Counter[tuple[int, ...]] = Counter()
    for seed in range(600):
        known, rng, order = Bandit(3), stream(seed, 0, Purpose.EXPLORE), []
        for _ in range(3):
            order.append(rule.choose(known, rng))
            known.choices += 1
            known.update(order[-1], 1.0, 2.0, rule.factor)
        orders[tuple(order)] += 1
    assert set(orders) == set(permutations(range(3)))
    assert chisquare(list(orders.values())).pvalue > SURE


@pytest.mark.parametrize("every", [5, 20, 1, 7])
def test_periodic_random_draws_every_nth_choice(every: int) -> None:
    rule, rng, known = PeriodicRandom(every=every), CountingGenerator(), Bandit(2)
    drawn_at = []
    for choice in range(1, 101):
        before = rng.calls
        arm = choose(rule, known, rng)
        known.choices += 1
        known.update(arm, [1.0, 2.0][arm], 4.0)
        if choice > 2:  # the first two choices are untried arms
            if rng.calls > before:
                drawn_at.append(choice)
            assert arm == (0 if rng.calls > before else 1)  # the random arm is 0, the best arm 1
    assert drawn_at == [choice for choice in range(3, 101) if choice % every == 0]


def test_periodic_random_draws_arms_uniformly() -> None:
    known, rng = bandit((0.1, 9), (0.9, 9), (0.2, 9)), stream(1, 2, Purpose.EXPLORE)
    known.choices = 4
    counts = Counter(PeriodicRandom().choose(known, rng) for _ in range(3000))
    assert chisquare([counts[arm] for arm in range(3)]).pvalue > SURE
    known.choices = 5
    assert {PeriodicRandom().choose(known, rng) for _ in range(100)} == {1}


@pytest.mark.parametrize(
    "known",
    [Bandit(4), bandit((1.0, 500), (-1.0, 1), (0.0, 1), (0.0, 1)), bandit((1.0, 5), *3 * [(0.0, 0)])],
    ids=["nothing known", "one far better", "one tried"],
)
def test_uniform_random_draws_arms_uniformly(known: Bandit) -> None:
    rng = stream(7, 3, Purpose.EXPLORE)
    counts = Counter(UniformRandom().choose(known, rng) for _ in range(4000))
    assert chisquare([counts[arm] for arm in range(4)]).pvalue > SURE


def test_uniform_random_choices_are_independent() -> None:
    rng, known = stream(7, 3, Purpose.EXPLORE), Bandit(2)
    arms = [UniformRandom().choose(known, rng) for _ in range(4001)]
    pairs = Counter(pairwise(arms))
    assert chisquare([pairs[pair] for pair in product((0, 1), repeat=2)]).pvalue > SURE


def test_the_test_of_uniformity_can_fail() -> None:
    rng = np.random.default_rng(5)
    counts = Counter(int(rng.random() < 0.55) for _ in range(4000))
    assert chisquare([counts[arm] for arm in range(2)]).pvalue < SURE


@pytest.mark.parametrize(("discount", "gamma"), [(0.99, 0.155), (0.9, 0.6), (0.5, 2.0), (1.0, 0.155)])
def test_discounted_ucb_equals_its_definition_over_the_whole_history(discount: float, gamma: float) -> None:
    """Garivier & Moulines: N_λ(a) = Σ_s λ^(t−s) 1{a_s = a}, and ΣR, ΣT likewise, at each of 400 conflicts."""
    rule, known, world = DiscountedUCB(discount=discount, gamma=gamma), Bandit(3), np.random.default_rng(11)
    assert rule.factor == discount
    arms: list[int] = []
    rewards: list[float] = []
    times: list[float] = []
    rng = stream(0, 0, Purpose.EXPLORE)
    for t in range(400):
        arm = rule.choose(known, rng)
        if t >= 3:
            weight = discount ** np.arange(t - 1, -1, -1.0)
            of_arm = [weight * (np.array(arms) == a) for a in range(3)]
            count = np.array([w.sum() for w in of_arm])
            reward = np.array([w @ np.array(rewards) for w in of_arm])
            time = np.array([w @ np.array(times) for w in of_arm])
            assert known.count == pytest.approx(count)
            bounds = reward / time + np.sqrt(gamma * np.log(count.sum()) / count)
            assert bounds[arm] >= bounds.max() - 1e-9
        times.append(world.uniform(1.0, 20.0))
        # The best arm changes over time, the case that discounting is for.
        rewards.append(times[-1] * (0.5 + 0.3 * math.cos(t / 60 + 2 * arm) + world.normal(0.0, 0.05)))
        arms.append(arm)
        known.choices += 1
        known.update(arm, rewards[-1], times[-1], rule.factor)
    assert min(Counter(arms).values()) > 5


def test_a_rule_without_its_own_weight_of_exploration_has_that_of_the_game() -> None:
    for rule in (UCB(), DiscountedUCB(discount=0.9)):
        assert rule.weight == GAMMA
        assert rule.in_game(0.3) == rule.replace(gamma=0.3)
        assert rule.in_game(0.3).in_game(0.2).weight == 0.3
    assert Greedy().in_game(0.3) == Greedy()


def test_defaults_of_the_rules() -> None:
    assert DiscountedUCB().discount == 0.99
    assert {name for name, rule in RULES.items() if rule().factor != 1.0} == {"discounted-ucb"}


@pytest.mark.parametrize(("discount", "gamma"), [(0.5, 0.0), (0.9, 0.0), (1e-3, 0.155)])
def test_discounted_ucb_retries_an_arm_with_a_tiny_count(discount: float, gamma: float) -> None:
    rule, known = DiscountedUCB(discount=discount, gamma=gamma), Bandit(2)
    for _ in range(8000):  # after so many discounts, the count of an arm underflows
        arm = choose(rule, known)
        known.update(arm, [0.0, 1.0][arm], [0.1, 2.0][arm], rule.factor)


OUT_OF_RANGE = {
    (UCB, "gamma"): (-0.001, math.nan, math.inf),
    (DiscountedUCB, "gamma"): (-0.001,),
    (DiscountedUCB, "discount"): (0.0, 1.001, math.nan),
    (PeriodicRandom, "every"): (0, 2.5, math.nan),
}


@pytest.mark.parametrize(("argument", "values"), OUT_OF_RANGE.items())
def test_values_out_of_range_are_refused(argument: tuple[type[Rule], str], values: tuple[float, ...]) -> None:
    rule, field = argument
    for value in values:
        with pytest.raises(InputError, match="must be") as caught:
            rule(**{field: value})
        assert (caught.value.field, repr(caught.value.value)) == (field, repr(value))


@pytest.mark.parametrize("rule", [UCB(), UCB(gamma=0.0), DiscountedUCB()], ids=repr)
def test_the_fast_choice_is_the_choice_of_the_rule(rule: UCB) -> None:
    fast, values = rule.fast_choose(), np.random.default_rng(2)
    bandit, rng, twin = Bandit(3), stream(1, 0, Purpose.EXPLORE), stream(1, 0, Purpose.EXPLORE)
    arms = []
    for _ in range(200):
        arms.append(fast(bandit, rng))
        assert arms[-1] == rule.choose(bandit, twin)
        bandit.update(arms[-1], float(values.integers(2)), 1.0, rule.factor)  # ties are frequent
    assert set(arms) == {0, 1, 2}
    assert rng.random() == twin.random()


def test_a_subclass_of_ucb_with_its_own_bounds_is_asked() -> None:
    class Reversed(UCB):
        def bounds(self, bandit: Bandit) -> list[float]:
            return [-bound for bound in super().bounds(bandit)]

    bandit = Bandit(2)
    bandit.update(0, 3.0, 1.0)
    bandit.update(1, 1.0, 1.0)
    rng = stream(0, 0, Purpose.EXPLORE)
    assert (UCB().fast_choose()(bandit, rng), Reversed().fast_choose()(bandit, rng)) == (0, 1)
