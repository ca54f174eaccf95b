"""Tables of results, with published numbers."""
