"""`python -m coif`: the coif command that came with this package, else the one on the PATH."""

import os
import shutil
import sys
import sysconfig


def main() -> int:
    folder = sysconfig.get_path("scripts")
    command = shutil.which("coif", path=folder) or shutil.which("coif")
    if command is None:
        print("coif: the command is not installed beside this package", file=sys.stderr)
        return 127
    os.execv(command, [command, *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
