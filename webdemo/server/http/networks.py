"""The part of an address that stands for one subscriber, by which limits count."""

from __future__ import annotations

import ipaddress

PREFIX = 64
"""Bits of an IPv6 address that a provider gives to one subscriber at least; the rest they choose themselves."""


def network_of(address: str) -> str:
    """An IPv4 address as it is, the /64 network of an IPv6 address, and the IPv4 address within a mapped one.

    Loopback, and what is no address (a name in a test, a socket's path), stays as it is.
    """
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(found, ipaddress.IPv4Address) or found.is_loopback:
        return str(found)
    if found.ipv4_mapped is not None:
        return str(found.ipv4_mapped)
    host_bits = 128 - PREFIX
    return f"{ipaddress.IPv6Address(int(found) >> host_bits << host_bits)}/{PREFIX}"
