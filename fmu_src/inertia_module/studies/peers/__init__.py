"""Other ways to integrate the module, measured beside it: one curve each in the plots."""

from ..trajectory import Peer

PEERS: tuple[Peer, ...] = ()
