import numba


@numba.njit(cache=True)
def swayed(action):
    return action * 1.0
