# docker build -t torsionnet .
# docker run --rm -v "$PWD:/work" --user "$(id -u)" torsionnet report plant.yaml
# `python -m release` runs the RUN lines up to the user's in a fresh environment where there is no container.
FROM python:3.13-slim AS build
WORKDIR /source
COPY . .
RUN python -m pip install --no-cache-dir "build==1.6.1"
RUN python -m build --wheel --outdir /wheels

FROM python:3.13-slim
LABEL org.opencontainers.image.title="torsionnet" \
      org.opencontainers.image.licenses="MIT" \
      org.opencontainers.image.url="https://torsionnet.example" \
      org.opencontainers.image.source="https://torsionnet.example/source"
COPY --from=build /wheels /wheels
RUN python -m pip install --no-cache-dir /wheels/*.whl
RUN torsionnet modes dmf_rig
RUN useradd --uid 1000 --create-home engineer
# Any user may run it; matplotlib and numba keep their caches where all may write.
ENV MPLCONFIGDIR=/tmp/matplotlib NUMBA_CACHE_DIR=/tmp/numba PYTHONUTF8=1
USER engineer
WORKDIR /work
ENTRYPOINT ["torsionnet"]
CMD ["--help"]
