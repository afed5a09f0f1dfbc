"""Parts of `.ci/release` that need no shell: archives whose bytes depend on their files only, and the texts of licences."""

import gzip
import hashlib
import json
import os
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

WHEN = int(os.environ.get("SOURCE_DATE_EPOCH", "0"))


def metadata(*arguments):
    command = ["cargo", "metadata", "--format-version=1", "--locked", *arguments]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def linked(target):
    """The packages of others that the program for a target is linked from, by name."""
    told = metadata("--filter-platform", target)
    packages = {package["id"]: package for package in told["packages"]}
    nodes = {node["id"]: node for node in told["resolve"]["nodes"]}
    seen, todo = set(), [p["id"] for p in packages.values() if p["name"] == "standstill-cli"]
    while todo:
        one = todo.pop()
        if one in seen:
            continue
        seen.add(one)
        for dep in nodes[one]["deps"]:
            if any(kind["kind"] is None for kind in dep["dep_kinds"]):
                todo.append(dep["pkg"])
    found = [packages[one] for one in seen if packages[one]["source"] is not None]
    return sorted(found, key=lambda package: (package["name"], package["version"]))


def licences(target, out):
    """Writes the licences of all that is linked: their texts as the packages bring them, each text once."""
    texts = {}
    lines = ["What the program is linked from beside its own packages, and under which licences.\n"]
    for package in linked(target):
        name = f"{package['name']} {package['version']}"
        if not package["license"]:
            sys.exit(f"{name} names no licence")
        lines.append(f"{name}: {package['license']}")
        folder = Path(package["manifest_path"]).parent
        for file in sorted(folder.iterdir()):
            if file.is_file() and file.name.upper().startswith(("LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE")):
                text = file.read_text(encoding="utf-8", errors="replace").strip().replace("\r\n", "\n")
                texts.setdefault(text, []).append(name)
    uplot = Path("crates/report/vendor/uPlot-LICENSE").read_text(encoding="utf-8").strip()
    lines.append("uPlot (in pages of runs): MIT")
    texts.setdefault(uplot, []).append("uPlot")
    for text, names in texts.items():
        lines.append(f"\n{'-' * 78}\n{', '.join(names)}\n\n{text}")
    Path(out).write_text("\n".join(lines) + "\n", encoding="utf-8")


def is_program(path):
    return path.name in ("standstill", "standstill.exe")


def pack(folder, archive):
    """Packs a folder: sorted, of one time and one owner."""
    folder = Path(folder)
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    if archive.endswith(".zip"):
        import time

        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as out:
            for path in files:
                info = zipfile.ZipInfo(str(path.relative_to(folder.parent)), time.gmtime(WHEN)[:6])
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = (0o100755 if is_program(path) else 0o100644) << 16
                out.writestr(info, path.read_bytes())
    else:
        with open(archive, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=WHEN) as packed:
            with tarfile.open(fileobj=packed, mode="w") as out:
                for path in files:
                    info = tarfile.TarInfo(str(path.relative_to(folder.parent)))
                    info.size, info.mtime = path.stat().st_size, WHEN
                    info.mode = 0o755 if is_program(path) else 0o644
                    with open(path, "rb") as file:
                        out.addfile(info, file)
    print(f"{archive}: {len(files)} files, {os.path.getsize(archive) / 1e6:.1f} MB")


def unpack(archive, folder):
    if archive.endswith(".zip"):
        with zipfile.ZipFile(archive) as packed:
            packed.extractall(folder)
    else:
        with tarfile.open(archive) as packed:
            packed.extractall(folder, filter="data")


def sums(folder):
    """SHA256SUMS, as `sha256sum --check` reads it."""
    files = sorted(path for path in Path(folder).iterdir() if path.is_file() and path.name != "SHA256SUMS")
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
    (Path(folder) / "SHA256SUMS").write_text("".join(lines))


def binstall(folder, version):
    """Every archive is named, and holds the program, where the package tells `cargo binstall` to look."""
    manifest = tomllib.loads(Path("crates/cli/Cargo.toml").read_text())
    told = manifest["package"]["metadata"]["binstall"]
    for path in sorted(Path(folder).glob("*.tar.gz")) + sorted(Path(folder).glob("*.zip")):
        target = path.name.removeprefix(f"standstill-v{version}-").removesuffix(".tar.gz").removesuffix(".zip")
        here = told | told.get("overrides", {}).get(target, {})
        is_zip = here["pkg-fmt"] == "zip"
        places = {
            "repo": "",
            "version": version,
            "target": target,
            "archive-suffix": ".zip" if is_zip else ".tar.gz",
            "bin": "standstill",
            "binary-ext": ".exe" if "windows" in target else "",
        }

        def filled(template):
            for place, value in places.items():
                template = template.replace("{ " + place + " }", value)
            return template

        if filled(here["pkg-url"]).rsplit("/", 1)[1] != path.name:
            sys.exit(f"cargo binstall looks for {filled(here['pkg-url'])}, and the archive is {path.name}")
        names = zipfile.ZipFile(path).namelist() if is_zip else tarfile.open(path).getnames()
        if filled(here["bin-dir"]) not in names:
            sys.exit(f"{path.name} has no {filled(here['bin-dir'])}")


if __name__ == "__main__":
    globals()[sys.argv[1]](*sys.argv[2:])
