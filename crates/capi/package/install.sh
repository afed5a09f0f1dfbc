#!/usr/bin/env bash
# Installs the C library below a prefix, for CMake and pkg-config to find: `bash crates/capi/package/install.sh PREFIX [PROFILE]`.
# The folder can be moved afterwards. PROFILE is a profile of Cargo, `dist` unless given.
set -euo pipefail
mkdir -p "${1:?where to}"
prefix=$(cd "$1" && pwd) profile=${2:-dist}
cd "$(dirname "$0")/../../.."
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
cargo build --locked --quiet --profile "$profile" -p standstill-capi --lib
case $profile in dev | test) folder=debug ;; *) folder=$profile ;; esac
built=${CARGO_TARGET_DIR:-target}/$folder
mkdir -p "$prefix/include" "$prefix/lib/cmake/standstill" "$prefix/lib/pkgconfig" "$prefix/share/licenses/standstill"
cp crates/capi/include/standstill.h crates/capi/include/standstill_blocks.h "$prefix/include/"
cp "$built/libstandstill_capi.a" "$prefix/lib/"
for shared in libstandstill_capi.so libstandstill_capi.dylib; do
    [ ! -f "$built/$shared" ] || cp "$built/$shared" "$prefix/lib/"
done
cp LICENSE-MIT LICENSE-APACHE "$prefix/share/licenses/standstill/"
cd crates/capi/package
for file in standstillConfig.cmake standstillConfigVersion.cmake; do
    sed "s/@VERSION@/$version/" "$file.in" >"$prefix/lib/cmake/standstill/$file"
done
sed "s/@VERSION@/$version/" standstill.pc.in >"$prefix/lib/pkgconfig/standstill.pc"
echo "standstill $version is in $prefix"
