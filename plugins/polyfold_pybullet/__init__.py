"""The robot cell: two arms at a table in PyBullet, their kinematics, and plans of folds that collide with nothing."""
