"""Prints where, under PREFIX, this interpreter looks for modules that are installed there."""
import os
import sys
import sysconfig

prefix = os.path.normpath(sys.argv[1])
# Debian: what packages bring is in /usr/lib/python3, what machines add in /usr/local/lib/python3.x.
scheme = "deb_system" if "deb_system" in sysconfig.get_scheme_names() and prefix == "/usr" else None
folder = sysconfig.get_path("platlib", scheme) if scheme else sysconfig.get_path("platlib")
for root in ("/usr/local", sys.prefix):
    if os.path.commonpath([root, folder]) == root:
        print(os.path.relpath(folder, root))
        break
else:
    print(f"lib/python{sysconfig.get_python_version()}/site-packages")
