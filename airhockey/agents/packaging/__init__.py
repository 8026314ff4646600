"""Submissions as things to hand in: what describes them, how they are packed, and how foreign archives are opened.

from airhockey.agents.packaging.packing import pack
from airhockey.agents.packaging.archive import opened
"""
