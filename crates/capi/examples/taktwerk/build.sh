#!/bin/sh
# Makes the model package: build.sh LIBRARY INCLUDE OUT, with the static library of standstill and the folder of its headers.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$3/lib/$(uname -m)"
${CC:-cc} -shared -fPIC -O2 -Wall -Wextra -Werror -I "$2" -o "$3/lib/$(uname -m)/axis.so" "$here/axis.c" "$1" \
    -lpthread -ldl -lm
taktwerk import-header "$here/axis.h" --shape --force -o "$3/taktwerk-model.toml"
