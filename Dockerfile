# Pas de Deux for a lab: the page, its API and its history, on the CPU of an x86-64 machine. See docs/deploying.md.
#   docker build -t pas-de-deux .
#   docker compose up
ARG BASE=python:3.11-slim
FROM ${BASE} AS build
RUN python -m venv /opt/venv
ENV PATH=/opt/venv/bin:$PATH PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1
WORKDIR /build
COPY requirements.lock requirements-ray.lock ./
ARG RAY=
RUN pip install --require-hashes --no-deps --extra-index-url https://download.pytorch.org/whl/cpu \
        -r requirements.lock ${RAY:+-r requirements-ray.lock} \
    && find /opt/venv \( -name __pycache__ -o -path '*/torch/test' -o -path '*/torch/include' \) -prune -exec rm -rf {} +

FROM ${BASE}
RUN groupadd --system --gid 10001 lab \
    && useradd --system --uid 10001 --gid lab --no-create-home --shell /usr/sbin/nologin lab \
    && install -d -o lab -g lab -m 700 /data
COPY --from=build /opt/venv /opt/venv
WORKDIR /app
COPY app.py ./
COPY acts acts
COPY motion motion
COPY models models
COPY static static
COPY webdemo webdemo
ENV PATH=/opt/venv/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1 \
    HF_HUB_OFFLINE=1 \
    PASDEDEUX_HOST=0.0.0.0 \
    PASDEDEUX_DATA=/data \
    PASDEDEUX_EXIT_WHEN_STUCK=1 \
    XDG_CACHE_HOME=/data/cache
USER 10001:10001
VOLUME /data
EXPOSE 7860
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=30s --timeout=10s --start-period=90s --retries=3 \
    CMD ["python", "-c", "import urllib.request as r; r.urlopen(r.Request('http://127.0.0.1:7860/healthz', headers={'Host': 'localhost'}), timeout=8)"]
CMD ["python", "app.py"]
