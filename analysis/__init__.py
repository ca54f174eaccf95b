"""What result files say: reading them, figures of them, and comparison with published numbers.

Nothing here simulates. pandas, matplotlib and seaborn are imported in this package alone.
"""
