"""What is told where a format needs a laser's power and the profile has none."""

from __future__ import annotations

from foldcut.jobs.errors import LackingError
from foldcut.jobs.model import JobStep
from foldcut.profiles import Profile


def no_power(step: JobStep, profile: Profile) -> LackingError:
    """Return the error for a step without power; for lasers it names what is missing."""
    what = f"the profile {profile.title!r} has no power for {step.role} on this material"
    if profile.kind != "laser" and profile.format != "lbrn2":
        return LackingError(what)
    action, values = "score" if step.action == "draw" else step.action, []
    for name, material in profile.materials.items():
        setting = getattr(material, action)
        if setting is None:
            values.append(f"materials.{name}.{action}.speed_mm_s=50")
        if setting is None or setting.power_percent is None:
            values.append(f"materials.{name}.{action}.power_percent=10")
    return LackingError(what, values)
