"""What sentences mean: programs of steps and goals, and the folds that these are on a garment."""
