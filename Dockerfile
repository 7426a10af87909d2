# The program alone, in an image of its own size:
#
#   docker build -t poecal .
#   docker run --rm --user "$(id -u):$(id -g)" -v "$PWD:/data" poecal calibrate robot.urdf measurements.csv
FROM rust:1-slim-bookworm AS build
WORKDIR /source
COPY . .
# The same that scripts/static-program does elsewhere.
RUN scripts/static-program

FROM scratch
COPY --from=build /source/target/static/poecal /poecal
COPY LICENSE-MIT LICENSE-APACHE THIRD-PARTY.txt /
WORKDIR /data
ENTRYPOINT ["/poecal"]
