"""What all packages share: errors, validated data, atomic files, compilation, limits."""
