"""Tables of results, beside published numbers."""
