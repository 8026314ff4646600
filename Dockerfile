# For organisers: evaluates an entry that is mounted, without network.
#   docker build -t airhockey .
#   docker run --rm --network none -v "$PWD/entry:/entry:ro" -v "$PWD/runs:/runs" airhockey evaluate --agent /entry --env 7dof-hit
FROM python:3.12-slim

# bubblewrap isolates entries inside the container where it allows user namespaces; OpenCV, which MushroomRL imports, wants the rest.
RUN apt-get update \
    && apt-get install -y --no-install-recommends bubblewrap libgl1 libglib2.0-0 \
    && rm -rf /var/lib/apt/lists/*

COPY pyproject.toml README.md LICENSE /src/
COPY airhockey /src/airhockey
# PyTorch for machines without a GPU is smaller: docker build --build-arg PIP_EXTRA_INDEX_URL=… (its own index for that).
ARG PIP_EXTRA_INDEX_URL=
RUN pip install --no-cache-dir "/src[mushroom]" && rm -rf /src

# Compile once, so that no evaluation waits for it; the sandbox reads this cache.
RUN cd /tmp && hockey evaluate --agent thesis --env 7dof-defend --episodes 1 --jobs 1 --quiet --out /tmp/warm && rm -rf /tmp/warm

RUN useradd --create-home organiser && mkdir /runs && chown organiser /runs
USER organiser
WORKDIR /
VOLUME /runs
ENTRYPOINT ["hockey"]
CMD ["--help"]
