"""Where a server listens: whether an address can be one, and whether a proxy stands in its way."""

from __future__ import annotations

from ipaddress import ip_address
from urllib.parse import urlsplit
from urllib.request import getproxies, proxy_bypass

from polyfold.errors import ConfigError


def check_address(address: str, source: str) -> None:
    """Refuse what can't be the address of a server.

    Args:
        address: of the server.
        source: who gave it, for the message.

    Raises:
        ConfigError: with an example.
    """
    try:
        parts = urlsplit(address)
        good = parts.scheme in ("http", "https") and parts.hostname and parts.port != 0 and not _SPACE & set(address)
    except ValueError:  # a port that is none
        good = False
    if not good:
        raise ConfigError(
            f"{address!r} is no address of a server ({source}); write http:// or https://, host and port, "
            "for example http://127.0.0.1:8000/v1"
        )


_SPACE = set(" \t\r\n")


def proxy_in_the_way(address: str | None) -> str:
    """What to say of a proxy that calls to a server of this machine are sent to; empty if there is none."""
    parts = urlsplit(address or "")
    host = parts.hostname or ""
    proxies = getproxies()
    if not _is_here(host) or not {parts.scheme, "all"} & proxies.keys() or proxy_bypass(host):
        return ""
    name = parts.scheme if parts.scheme in proxies else "all"
    return f"; {name.upper()}_PROXY sends calls to {host} through a proxy: set NO_PROXY={host} to reach it directly"


def _is_here(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
