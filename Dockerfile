# The program and the Python module, from this checkout:
#
#   docker build -t innermap .
#   docker run --rm -v "$PWD":/data -w /data innermap map rest.obj pose.obj -o out
FROM debian:12 AS build
WORKDIR /src
COPY scripts scripts
RUN scripts/install-packages build libraries python package && apt-get install -y --no-install-recommends git
COPY . .
RUN git config --global --add safe.directory /src \
 && cmake --preset package \
 && cmake --build --preset package -j "$(scripts/build-jobs)" \
 && cd build/package && cpack

FROM debian:12-slim
COPY --from=build /src/build/package/*.deb /packages/
RUN apt-get update \
 && apt-get install -y --no-install-recommends /packages/innermap_*.deb /packages/innermap-images_*.deb \
      /packages/python3-innermap_*.deb fonts-dejavu-core \
 && rm -rf /packages /var/lib/apt/lists/*
ENTRYPOINT ["innermap"]
CMD ["--help"]
