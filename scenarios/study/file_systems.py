"""Network file systems, on which SQLite needs care."""

import re
from pathlib import Path
from typing import Final

_MOUNTS: Path = Path("/proc/self/mountinfo")
"""File of the mounted file systems (Linux)."""
_NETWORK: Final = re.compile(
    r"nfs\d?|cifs|smb\w*|ncpfs|afs|9p|ceph|lustre|gpfs|beegfs\w*|pvfs2|orangefs|panfs|glusterfs|ocfs2|gfs2|davfs2?"
    r"|fuse\.(sshfs|s3fs|gcsfuse|goofys|rclone|glusterfs|ceph(-fuse)?|davfs2?|gvfsd-fuse|blobfuse2?|juicefs"
    r"|smbnetfs|curlftpfs|mount\.\w+|beegfs\w*)"
)


def network_file_system(directory: Path) -> str:
    """Return the type of the network file system of a directory, such as ``nfs4``; empty if it is local.

    The directory need not exist. Where the mounted file systems are not known, the result is empty.
    """
    try:
        mounts = _MOUNTS.read_text(encoding="utf-8", errors="surrogateescape").splitlines()
        real = directory.resolve()
    except OSError:
        return ""
    found, longest = "", 0
    for mount in mounts:
        before, _, after = mount.partition(" - ")
        point = Path(re.sub(r"\\(\d{3})", lambda code: chr(int(code[1], 8)), before.split(" ")[4]))
        if real.is_relative_to(point) and len(point.parts) >= longest:  # a later mount hides an earlier one
            found, longest = after.split(" ")[0], len(point.parts)
    return found if _NETWORK.fullmatch(found) else ""
