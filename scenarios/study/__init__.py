"""A study: a results directory that can be resumed, with its ledger and its tables."""
