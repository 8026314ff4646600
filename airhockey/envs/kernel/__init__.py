"""The compiled inside of a control step. Every function here is numba's: no Python objects, no global interpreter lock.

One idea per module: `arm` (the arm as arrays), `chain`, `kinematics`, `dynamics`, `interpolation`, `controller`,
`universal_joint`, `constraints`, `observation`, `opponent`, `engine` (MuJoCo's own functions), `plant` (its arrays), and
`control_step`, which joins them. What is allowed to be used from elsewhere stands in `airhockey.envs.compiled`.
"""
