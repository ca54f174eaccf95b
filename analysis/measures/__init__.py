"""What is computed from results: utilities and contributions."""
