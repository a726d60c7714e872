"""What the robot cell can do: inverse kinematics, folds that the arms plan, and whether a plan hits anything."""
