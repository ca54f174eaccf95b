"""A study: a directory of results that resumes, its ledger and its tables."""
