"""Reading results, recorded tables and published numbers."""
