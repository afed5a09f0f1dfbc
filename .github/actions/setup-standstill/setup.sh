#!/usr/bin/env bash
# Gets the archive of a release for this machine, holds it against the checksums beside it, and puts the program on the path of the
# steps that follow. `.ci/release --try` runs it on what it built.
set -euo pipefail
version=${VERSION:?which release: an action that is named by a commit needs the input version}
from=${FROM:-$REPOSITORY/releases/download/$version}
folder=${RUNNER_TEMP:-$(mktemp -d)}/standstill

ending=tar.gz
case ${RUNNER_OS:-$(uname -s)}-${RUNNER_ARCH:-$(uname -m)} in
    Linux-X64 | Linux-x86_64) target=x86_64-unknown-linux-musl ;;
    Linux-ARM64 | Linux-aarch64) target=aarch64-unknown-linux-musl ;;
    Windows-X64) target=x86_64-pc-windows-gnu ending=zip ;;
    macOS-X64) target=x86_64-apple-darwin ;;
    macOS-ARM64) target=aarch64-apple-darwin ;;
    *) echo "there is no archive for ${RUNNER_OS:-$(uname -s)} on ${RUNNER_ARCH:-$(uname -m)}" >&2; exit 1 ;;
esac
name=standstill-$version-$target

mkdir -p "$folder"
cd "$folder"
for file in "$name.$ending" SHA256SUMS; do
    curl --fail --silent --show-error --location --retry 3 --output "$file" "$from/$file"
done
sums=(sha256sum)
command -v sha256sum >/dev/null || sums=(shasum -a 256)
grep "  $name.$ending\$" SHA256SUMS | "${sums[@]}" --check -
case $ending in
    zip) unzip -q -o "$name.zip" ;;
    *) tar -xzf "$name.tar.gz" ;;
esac
echo "$folder/$name" >>"${GITHUB_PATH:-/dev/null}"
echo "version=$("$folder/$name/standstill" --version)" | tee -a "${GITHUB_OUTPUT:-/dev/null}"
