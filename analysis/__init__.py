"""Analysis of results: tables, measures, figures, films, findings and the report.

This package reads results and does not simulate. Only this package imports pandas, matplotlib and seaborn.
"""
