from air_hockey_agent.tasks import Hit, Stand

AGENTS = {"hit": Hit, "hit_single": Hit, "defend": Stand, "prepare": Stand, "tournament": Stand}


def build_agent(env_info, **kwargs):
    return AGENTS[env_info["env_name"]](env_info, **kwargs)
