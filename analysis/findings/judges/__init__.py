"""Judging each kind of claim: the interval of its effect, and its verdict."""
