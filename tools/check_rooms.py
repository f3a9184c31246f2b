#!/usr/bin/env python3
"""Fails on an include that the house forbids: a room may include only the rooms to its left, third parties stay
behind the rooms that own them, and public headers show none but Eigen."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROOMS = {
    "base": [],
    "scalp": ["base"],
    "hairmesh": ["base", "scalp"],
    "place": ["base", "hairmesh"],
    "strands": ["base", "scalp", "hairmesh"],
    "style": ["base", "scalp", "hairmesh", "strands"],
    "simulate": ["base", "scalp", "hairmesh", "strands"],
    "light": ["base", "scalp", "strands"],
    "preview": ["base", "scalp", "hairmesh", "strands", "light"],
    "io": ["base", "scalp", "hairmesh", "strands"],
    "scene": ["base", "scalp", "hairmesh", "place", "strands", "style", "simulate", "light", "io"],
}
THIRD_PARTIES = {  # first path element of an include -> rooms that may use it
    "oneapi": ["base"], "tbb": ["base"], "hwy": ["base"],
    "OpenMesh": ["scalp", "hairmesh"], "igl": ["scalp", "place"], "opensubdiv": ["hairmesh"],
    "embree3": ["light"], "epoxy": ["preview"], "EGL": ["preview"], "GL": ["preview"],
    "tiny_gltf.h": ["io"], "lz4.h": ["io"], "nlohmann": ["io", "scene"], "stb": ["light"], "OpenEXR": ["light"],
    "CLI": [], "imgui.h": [], "GLFW": [], "nanobind": [],
}
PUBLIC_ALLOWED = {"Eigen"}
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]')


def faults_of(path, room, public):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        target = match.group(1)
        parts = target.split("/")
        place = f"{path.relative_to(ROOT)}:{number}"
        if parts[0] == "coif" and len(parts) > 2:
            other = parts[1]
            if other != room and other not in ROOMS[room]:
                yield f"{place}: room '{room}' may not include room '{other}'"
        elif parts[0] in ROOMS and len(parts) > 1:
            if parts[0] != room:
                yield f"{place}: private header of room '{parts[0]}' used from '{room}'"
            elif public:
                yield f"{place}: public header includes a private one"
        elif parts[0] in THIRD_PARTIES:
            if public and parts[0] not in PUBLIC_ALLOWED:
                yield f"{place}: public header shows third party '{parts[0]}'"
            elif room not in THIRD_PARTIES[parts[0]]:
                yield f"{place}: third party '{parts[0]}' does not belong in room '{room}'"


def apps_faults():
    """Applications and the Python module compose: they reach rooms by public headers only."""
    for folder in ("apps", "python", "examples", "bench"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix not in (".cpp", ".h"):
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                match = INCLUDE.match(line)
                if match and match.group(1).split("/")[0] in ROOMS:
                    yield f"{path.relative_to(ROOT)}:{number}: private header '{match.group(1)}' of a room"


def main():
    faults, files = list(apps_faults()), 0
    for room in ROOMS:
        for folder, public in ((ROOT / "include/coif" / room, True), (ROOT / "src" / room, False)):
            for path in sorted(folder.rglob("*")):
                if path.suffix in (".h", ".cpp"):
                    files += 1
                    faults += faults_of(path, room, public)
    if files == 0:
        faults.append("no source file found: is this the right folder?")
    print("\n".join(faults) if faults else f"{files} files keep to their rooms")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
