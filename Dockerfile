# docker build -t seatrial . && docker run --rm seatrial       the demonstration
# docker run --rm -v "$PWD:/work" -w /work seatrial seatrial run TRIAL     with your own files
FROM debian:bookworm-slim AS base
RUN apt-get update && \
    apt-get install -y --no-install-recommends ca-certificates libglib2.0-0 libx11-6 libxext6 libxrender1 make \
        python3 python3-venv && \
    rm -rf /var/lib/apt/lists/*

# Compilers and tools of the tests, for the dev container.
FROM base AS develop
RUN apt-get update && \
    apt-get install -y --no-install-recommends \
        arduino-core-avr avr-libc bubblewrap chromium g++ g++-multilib gcc gcc-avr git libelf-dev libpython3-dev \
        libsimavr-dev npm && \
    rm -rf /var/lib/apt/lists/*

FROM base
RUN useradd --create-home sailor
USER sailor
WORKDIR /home/sailor/seatrial
COPY --chown=sailor . .
RUN make .venv/.installed
ENV PATH="/home/sailor/seatrial/.venv/bin:$PATH"
CMD ["make", "demo"]
