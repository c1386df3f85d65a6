# A container with the program, its Python packages and what they need: docker build -t splitgrain . && docker run splitgrain --version
FROM debian:12
RUN apt-get update && apt-get install -y --no-install-recommends \
      gfortran g++ cmake ninja-build libtomlplusplus-dev libmetis-dev libfftw3-dev libsuitesparse-dev libqhull-dev liblapack-dev \
      openmpi-bin libopenmpi-dev libhdf5-openmpi-dev \
      python3 python3-h5py python3-matplotlib python3-numpy python3-pandas && \
    rm -rf /var/lib/apt/lists/*
COPY . /source
RUN cmake -S /source -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DSPLITGRAIN_NATIVE=OFF -DBUILD_TESTING=OFF && \
    cmake --build /build && cmake --install /build --prefix /usr/local && rm -rf /build
ENV PYTHONPATH=/usr/local/share/splitgrain/postpro OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
WORKDIR /work
ENTRYPOINT ["splitgrain"]
