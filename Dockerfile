# posicast with all tools that `posicast run` and `posicast verify` need:
#   docker build -t posicast .
#   docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/work" posicast run machine.toml
FROM rust:1-bookworm AS build
WORKDIR /source
COPY . .
RUN cargo install --path cli --profile dist --root /opt/posicast --locked

FROM debian:12-slim
RUN apt-get update \
    && apt-get install -y --no-install-recommends verilator make g++ yosys iverilog \
    && rm -rf /var/lib/apt/lists/*
COPY --from=build /opt/posicast/bin/posicast /usr/local/bin/posicast
RUN posicast doctor
# The cache of built simulations is a folder that every user may write, and that a volume may keep.
ENV POSICAST_CACHE=/tmp/posicast
WORKDIR /work
ENTRYPOINT ["posicast"]
