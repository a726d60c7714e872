# docker build -t polyfold . && docker run --rm -v "$PWD/runs:/runs" polyfold fold "fold the t-shirt into a block" --out /runs/fold
# With extras: docker build --build-arg EXTRAS='[torch,llm]' -t polyfold .
FROM python:3.12-slim
ARG EXTRAS=""
WORKDIR /src
COPY pyproject.toml constraints.txt README.md LICENSE ./
COPY polyfold polyfold
COPY plugins plugins
COPY prompts prompts
# Folded once, so that the image holds the compiled code.
RUN pip install --no-cache-dir --constraint constraints.txt ".${EXTRAS}" \
    && cd / && rm -rf /src && polyfold fold "fold it in half" --garment square
WORKDIR /runs
ENTRYPOINT ["polyfold"]
