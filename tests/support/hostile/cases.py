"""The table of all hostile FMUs."""

from __future__ import annotations

from support.hostile.behaviors import CALLS, ENDS, PROCESS, STATUSES, VALUES
from support.hostile.case import Case
from support.hostile.descriptions import DESCRIPTIONS
from support.hostile.packages import ARCHIVES, LIBRARIES

GROUPS: dict[str, list[Case]] = {
    "Ends or hangs in a step": ENDS,
    "Loading, initialization, termination": CALLS,
    "Status": STATUSES,
    "Values": VALUES,
    "Messages, and what is done to the process": PROCESS,
    "Description": DESCRIPTIONS,
    "Archive": ARCHIVES,
    "Library": LIBRARIES,
}
CASES = [(case, fmi) for group in GROUPS.values() for case in group for fmi in case.versions]
