# SPDX-License-Identifier: GPL-3.0-or-later
"""One of machine_peers for somebody else's test: show_peer.py printer|octoprint FOLDER PORT PEERS. Prints what it is reached by, and ends
with its standard input. In a mount namespace of its own, but on the network of whoever starts it."""
import json
import os
import pathlib
import sys

kind, folder, port, peers = sys.argv[1:5]
if os.environ.get("FORMWRIGHT_OWN_NETWORK") != "yes":
    os.environ["FORMWRIGHT_OWN_NETWORK"] = "yes"  # machine_peers would move to one
    flags = ["-m"] if os.geteuid() == 0 else ["-r", "-m"]
    os.execvp("unshare", ["unshare", *flags, sys.executable, *sys.argv])
sys.argv = [sys.argv[0], "", "", peers]

import machine_peers  # noqa: E402

if kind == "printer":
    peer = machine_peers.Printer(pathlib.Path(folder), int(port))
    print(json.dumps({"url": peer.url, "spool": str(peer.spool)}), flush=True)
else:
    peer = machine_peers.OctoPrint(pathlib.Path(folder), int(port))
    print(json.dumps({"url": peer.url, "key": peer.KEY}), flush=True)
sys.stdin.read()
peer.stop()
