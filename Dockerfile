# flexlink in an image that holds nothing else:
#     docker build -t flexlink .
#     docker run --rm -u "$(id -u):$(id -g)" -v "$PWD:/work" flexlink solve link.toml motion.csv

FROM rust:1-slim AS build
WORKDIR /source
COPY . .
# The registry and the compiled dependencies stay in caches of the builder: a change of the sources
# compiles flexlink alone. What is in a cache is not in the image, hence the copy.
RUN --mount=type=cache,target=/usr/local/cargo/registry \
    --mount=type=cache,target=/source/target \
    target="$(uname -m)-unknown-linux-gnu" \
    && RUSTFLAGS='-C target-feature=+crt-static' \
       cargo build --release --locked --bin flexlink --target "$target" \
    && cp "target/$target/release/flexlink" / \
    && mkdir /work

FROM scratch
COPY --from=build /flexlink /bin/flexlink
COPY --from=build --chown=65532:65532 /work /work
USER 65532:65532
WORKDIR /work
ENTRYPOINT ["/bin/flexlink"]
