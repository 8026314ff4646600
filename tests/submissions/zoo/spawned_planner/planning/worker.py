"""Runs in a process of its own: it imports the entry's packages as the agent does."""


def plan(requests, answers):
    from air_hockey_agent.shapes import wave

    while (phase := requests.get()) is not None:
        answers.put(wave(phase))
