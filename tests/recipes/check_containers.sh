#!/bin/sh
# Build the Dockerfile, and the Apptainer definition as spython translates it, without a daemon and without a registry of images: by
# buildah, on a Debian 12 that debootstrap makes; then let both containers run a deck on two ranks and draw it. As root; 20 CPU minutes.
#
# usage: check_containers.sh SPYTHON FOLDER [DOCKERFILE or DEFINITION]
set -eu
spython=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)
top=$(cd "$(dirname "$0")/../.." && pwd)
build_images() {
  buildah --root "$folder/store" --runroot "$folder/run" "$@"
}

if ! build_images inspect --type image docker.io/library/debian:12 >/dev/null 2>&1; then
  debootstrap --variant=minbase bookworm "$folder/debian" >"$folder/debootstrap.log"
  base=$(build_images from scratch)
  build_images add -q "$base" "$folder/debian" /
  build_images commit -q "$base" docker.io/library/debian:12
  build_images rm "$base" >/dev/null
fi
rm -rf "$folder/source"
git clone -q "$top" "$folder/source"
# spython leaves out a word that HEALTHCHECK needs.
"$spython" recipe --parser singularity --writer docker "$top/packaging/splitgrain.def" | sed 's/^HEALTHCHECK /HEALTHCHECK CMD /' >"$folder/definition"
cp "$top/Dockerfile" "$folder/dockerfile"
for recipe in ${3:-dockerfile definition}; do
  build_images bud -q --isolation chroot --pull=never -f "$folder/$recipe" -t "splitgrain-$recipe" "$folder/source"
  container=$(build_images from --pull=never "localhost/splitgrain-$recipe")
  build_images run --isolation chroot "$container" sh -euc '
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    if [ -f /tests.sh ]; then bash /tests.sh; else splitgrain --version; fi
    deck=/usr/local/share/splitgrain/input_decks/collapsing_column.toml
    mpiexec --oversubscribe -n 2 splitgrain run $deck --set time.steps=50 --set output.every=25 --output /tmp/column --quiet
    splitgrain look summary /tmp/column
    splitgrain look page /tmp/column
    python3 -c "import splitgrain; assert len(splitgrain.Run(\"/tmp/column\").record) > 1"'
  build_images rm "$container" >/dev/null
  echo "check_containers: $recipe builds and runs"
done
