"""The ``xpbd`` simulator: cloth on a table as particles under XPBD, with layered self-contact, on one CPU core."""
