"""Many environments as one: stepped by threads inside a single compiled call.

    from airhockey import envs

    vec = envs.make_vec("7dof-hit", num_envs=64, threads=2, seed=0)
    batch = vec.reset()
    batch = vec.step(actions)

`environment` is the batch itself; `gymnasium` and `stable_baselines3` are what those libraries expect of one. What every
environment does is the same to the bit as what `airhockey.envs.Environment` does alone, whatever the number of
environments and threads.
"""
